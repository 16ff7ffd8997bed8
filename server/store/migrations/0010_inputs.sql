-- What a job was made from is watched like what it made: each input has the hash of what came in. Old rows: not known,
-- so nobody can tell whether they have changed.
ALTER TABLE job_input ADD COLUMN sha256 TEXT CHECK(length(sha256) = 64);

CREATE TABLE input_damage(
  job_seq INTEGER NOT NULL,
  name TEXT NOT NULL,
  detail TEXT NOT NULL,                     -- a sentence for people
  found_ms INTEGER NOT NULL,
  PRIMARY KEY(job_seq, name),
  FOREIGN KEY(job_seq, name) REFERENCES job_input(job_seq, name) ON DELETE CASCADE) STRICT, WITHOUT ROWID;

-- The check looks at all artefacts, then at all inputs.
ALTER TABLE integrity ADD COLUMN at_inputs INTEGER NOT NULL DEFAULT 0 CHECK(at_inputs IN (0, 1));
