-- Disks forget. The service reads every file that it keeps once in a while, a share of them each night, and says which
-- are no longer what they were when they were made: those are refused instead of being given out with wrong bytes.
-- Old rows: nothing is known to be damaged, and nothing has been looked at.
CREATE TABLE damage(
  job_seq INTEGER NOT NULL,
  path TEXT NOT NULL,
  detail TEXT NOT NULL,                     -- a sentence for people
  found_ms INTEGER NOT NULL,
  PRIMARY KEY(job_seq, path),
  FOREIGN KEY(job_seq, path) REFERENCES artefact(job_seq, path) ON DELETE CASCADE) STRICT, WITHOUT ROWID;

-- One row: how far the check has come.
CREATE TABLE integrity(
  id INTEGER PRIMARY KEY CHECK(id = 1),
  ended_ms INTEGER NOT NULL DEFAULT 0,      -- when the last share was done; 0: none was yet
  round_ms INTEGER NOT NULL DEFAULT 0,      -- when all files had been looked at last; 0: not yet
  after_seq INTEGER NOT NULL DEFAULT 0,     -- the next share begins after this file
  after_path TEXT NOT NULL DEFAULT '') STRICT;
INSERT INTO integrity(id) VALUES (1);
