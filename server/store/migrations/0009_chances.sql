-- A retry gives all chances anew, and so does progress: what befell earlier attempts (a full disk, a server that was
-- killed) is no longer held against the job. Old rows: everything still counts.
ALTER TABLE job ADD COLUMN forgiven_attempt INTEGER NOT NULL DEFAULT 0; -- attempts up to this one count no more
