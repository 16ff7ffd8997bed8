-- key_frame_count held the solved frames, check frames and all. Now it is those of kind key, as in the reports.
ALTER TABLE job ADD COLUMN solved_frame_count INTEGER; -- of kind key or check; NULL before they are known

UPDATE job SET
  solved_frame_count = key_frame_count,
  key_frame_count = (SELECT nullif(count(*), 0) FROM frame WHERE job_seq = seq AND kind = 'key');
