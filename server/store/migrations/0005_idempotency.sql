-- A client whose connection broke sends its job again with the same Idempotency-Key and gets the same job. The key
-- is written in the transaction that makes the job: whatever crashes, there are both or neither. It goes with the
-- job, or when it is old.
CREATE TABLE idempotency_key(
  owner TEXT NOT NULL,
  key TEXT NOT NULL CHECK(length(key) BETWEEN 1 AND 255),
  job_seq INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE,
  request_sha256 TEXT NOT NULL CHECK(length(request_sha256) = 64), -- of what was uploaded: another body is an error
  created_ms INTEGER NOT NULL,
  PRIMARY KEY(owner, key)) STRICT, WITHOUT ROWID;
CREATE INDEX idempotency_key_by_job ON idempotency_key(job_seq);
CREATE INDEX idempotency_key_by_age ON idempotency_key(created_ms);
