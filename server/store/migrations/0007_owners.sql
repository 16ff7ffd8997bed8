-- A blob belongs to whoever sent it: that another owner has sent the same bytes is nobody's business, so each has a
-- row, and each row counts as if the bytes were not shared on disk. Files that lie there from before have no row and
-- go at the next start: they were a cache of a day.
CREATE TABLE blob(
  owner TEXT NOT NULL,
  sha256 TEXT NOT NULL CHECK(length(sha256) = 64),
  bytes INTEGER NOT NULL CHECK(bytes >= 0),
  used_ms INTEGER NOT NULL,                 -- when it was sent or named last, give or take an hour
  PRIMARY KEY(owner, sha256)) STRICT, WITHOUT ROWID;
CREATE INDEX blob_by_age ON blob(used_ms);
CREATE INDEX blob_by_hash ON blob(sha256);

-- Which finished jobs nobody has looked at for longest, for whoever would rather lose those than refuse new ones.
ALTER TABLE job ADD COLUMN used_ms INTEGER NOT NULL DEFAULT 0; -- when results were asked for last; 0: never
ALTER TABLE job ADD COLUMN last_ms INTEGER GENERATED ALWAYS AS (max(coalesce(finished_ms, 0), used_ms)) VIRTUAL;
CREATE INDEX job_unused ON job(last_ms, bytes) WHERE finished_ms IS NOT NULL AND pinned = 0 AND removing = 0;

-- Owners see their own jobs only: lists by state and counts must not go through everybody's.
CREATE INDEX job_by_owner_state ON job(owner, state, seq);
