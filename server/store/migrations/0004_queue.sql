-- Jobs can be paused, resumed and tried again, have an owner, a priority, labels, and limits in time; the queue
-- as a whole can be paused. Why a new table for jobs: what a CHECK admits cannot be altered. Old rows: of no
-- owner, of middle priority, waiting since they were submitted.

DROP TRIGGER job_step_is_allowed;
DROP TRIGGER job_starts_queued;

DELETE FROM job_step;
INSERT INTO job_step(from_state, to_state) VALUES
  ('queued', 'running'),
  ('queued', 'paused'),
  ('queued', 'canceled'),
  ('queued', 'failed'),                     -- its deadline passed before it was started
  ('running', 'succeeded'),
  ('running', 'failed'),
  ('running', 'queued'),
  ('running', 'pause_requested'),
  ('running', 'cancel_requested'),
  ('pause_requested', 'succeeded'),
  ('pause_requested', 'failed'),
  ('pause_requested', 'paused'),
  ('pause_requested', 'cancel_requested'),
  ('paused', 'queued'),
  ('paused', 'canceled'),
  ('paused', 'failed'),
  ('cancel_requested', 'canceled'),
  ('failed', 'queued'),
  ('canceled', 'queued');

CREATE TABLE new_job(
  seq INTEGER PRIMARY KEY AUTOINCREMENT,    -- orders the list; never used twice, so that a cursor stays right
  id TEXT NOT NULL UNIQUE CHECK(length(id) = 30 AND id GLOB 'job_*'),
  name TEXT NOT NULL,
  owner TEXT NOT NULL DEFAULT '',           -- name of the token that it was submitted with; '': none was asked for
  state TEXT NOT NULL
    CHECK(state IN ('queued', 'running', 'pause_requested', 'paused', 'cancel_requested', 'succeeded', 'failed',
                    'canceled')),
  reason TEXT NOT NULL DEFAULT '',          -- stable word: why it is in this state
  message TEXT NOT NULL DEFAULT '',         -- a sentence for people
  frame_count INTEGER NOT NULL CHECK(frame_count >= 1),
  fps REAL NOT NULL CHECK(fps > 0),
  input_bytes INTEGER NOT NULL CHECK(input_bytes >= 0),
  key_frame_count INTEGER,                  -- of kind key; NULL before they are known
  solved_frame_count INTEGER,               -- of kind key or check; NULL likewise
  stage TEXT,
  stage_fraction REAL NOT NULL DEFAULT 0 CHECK(stage_fraction BETWEEN 0 AND 1),
  fraction REAL NOT NULL DEFAULT 0 CHECK(fraction BETWEEN 0 AND 1),
  seconds_left REAL CHECK(seconds_left >= 0), -- as the worker expects; NULL: nothing to tell it by
  progress_message TEXT NOT NULL DEFAULT '',
  best_fraction REAL NOT NULL DEFAULT 0,    -- highest fraction that any attempt reached
  attempt INTEGER NOT NULL DEFAULT 0,
  attempts_without_progress INTEGER NOT NULL DEFAULT 0,
  not_before_ms INTEGER NOT NULL DEFAULT 0, -- no attempt before this time (waiting for disk space)
  lease INTEGER NOT NULL DEFAULT 0,         -- fencing token: only its holder may write for this attempt
  report TEXT,                              -- the worker's last report, as JSON
  forecast TEXT,                            -- what it is expected to take, as JSON; NULL: not known
  memory_bytes INTEGER NOT NULL DEFAULT 0 CHECK(memory_bytes >= 0), -- of the forecast: room that its worker needs
  version INTEGER NOT NULL DEFAULT 1,
  removing INTEGER NOT NULL DEFAULT 0 CHECK(removing IN (0, 1)), -- files are being deleted, the row goes last
  priority INTEGER NOT NULL DEFAULT 50 CHECK(priority BETWEEN 0 AND 100),
  queued_ms INTEGER NOT NULL,               -- since when it waits, for its place in the queue
  -- Its place among the jobs of its owner, smallest first. A minute of waiting is worth a point of priority; all
  -- wait at the same pace, so the order does not change with time and an index can hold it.
  rank_ms INTEGER GENERATED ALWAYS AS (queued_ms - priority * 60000) VIRTUAL,
  deadline_ms INTEGER,                      -- not started, or not done, by then: failed
  max_run_ms INTEGER CHECK(max_run_ms > 0), -- all attempts together
  run_ms INTEGER NOT NULL DEFAULT 0 CHECK(run_ms >= 0), -- of attempts that have ended, since submitted or retried
  created_ms INTEGER NOT NULL,
  updated_ms INTEGER NOT NULL,
  started_ms INTEGER,
  finished_ms INTEGER,
  CHECK((finished_ms IS NOT NULL) = (state IN ('succeeded', 'failed', 'canceled')))) STRICT;

INSERT INTO new_job(seq, id, name, state, reason, message, frame_count, fps, input_bytes, key_frame_count,
  solved_frame_count, stage, stage_fraction, fraction, seconds_left, progress_message, best_fraction, attempt,
  attempts_without_progress, not_before_ms, lease, report, version, removing, queued_ms, created_ms, updated_ms,
  started_ms, finished_ms)
SELECT seq, id, name, state, reason, message, frame_count, fps, input_bytes, key_frame_count,
  solved_frame_count, stage, stage_fraction, fraction, seconds_left, progress_message, best_fraction, attempt,
  attempts_without_progress, not_before_ms, lease, report, version, removing, created_ms, created_ms, updated_ms,
  started_ms, finished_ms FROM job;

-- Jobs that are gone count too: their numbers must not come back.
DELETE FROM sqlite_sequence WHERE name = 'new_job';
INSERT INTO sqlite_sequence(name, seq) SELECT 'new_job', seq FROM sqlite_sequence WHERE name = 'job';

DROP TABLE job;
ALTER TABLE new_job RENAME TO job;

-- The next job of an owner that fits, without touching the table.
CREATE INDEX job_turn ON job(owner, rank_ms, seq, not_before_ms, memory_bytes, state) WHERE state = 'queued';
-- The most urgent job of an owner.
CREATE INDEX job_urgency ON job(owner, priority, state) WHERE state = 'queued';
CREATE INDEX job_by_state ON job(state, seq);
CREATE INDEX job_by_owner ON job(owner, seq);
CREATE INDEX job_deadline ON job(deadline_ms) WHERE deadline_ms IS NOT NULL AND state IN ('queued', 'paused');

CREATE TRIGGER job_step_is_allowed BEFORE UPDATE OF state ON job
WHEN NOT EXISTS (SELECT 1 FROM job_step WHERE from_state = OLD.state AND to_state = NEW.state)
BEGIN
  SELECT RAISE(ABORT, 'step between job states is not allowed');
END;

CREATE TRIGGER job_starts_queued BEFORE INSERT ON job WHEN NEW.state <> 'queued'
BEGIN
  SELECT RAISE(ABORT, 'a job starts queued');
END;

CREATE TABLE job_label(
  job_seq INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE,
  name TEXT NOT NULL CHECK(length(name) BETWEEN 1 AND 64),
  value TEXT NOT NULL,
  PRIMARY KEY(job_seq, name)) STRICT, WITHOUT ROWID;
CREATE INDEX job_label_value ON job_label(name, value, job_seq);

-- When a job of an owner was started last, so that owners take turns across restarts.
CREATE TABLE owner_turn(
  owner TEXT PRIMARY KEY,
  started_ms INTEGER NOT NULL) STRICT, WITHOUT ROWID;

-- One row. Paused: jobs that run go on, none is started.
CREATE TABLE queue(
  id INTEGER PRIMARY KEY CHECK(id = 1),
  paused INTEGER NOT NULL DEFAULT 0 CHECK(paused IN (0, 1)),
  reason TEXT NOT NULL DEFAULT '',
  changed_ms INTEGER NOT NULL DEFAULT 0) STRICT;
INSERT INTO queue(id) VALUES (1);
