-- Jobs, their attempts, what happened to them, and what they left behind.
-- Why so: the state is one checked column, never flags, and the steps allowed between states are a table
-- that a trigger enforces, so that no code path, not even a future one, can make an illegal step. Files lie
-- on disk; a row exists only for a file that is whole. Times are milliseconds since 1970, UTC.

CREATE TABLE job_step(
  from_state TEXT NOT NULL,
  to_state TEXT NOT NULL,
  PRIMARY KEY(from_state, to_state)) STRICT, WITHOUT ROWID;

INSERT INTO job_step(from_state, to_state) VALUES
  ('queued', 'running'),
  ('queued', 'canceled'),
  ('running', 'succeeded'),
  ('running', 'failed'),
  ('running', 'queued'),
  ('running', 'cancel_requested'),
  ('cancel_requested', 'canceled');

-- seq orders the list and the queue; AUTOINCREMENT so that a cursor never meets a reused number.
CREATE TABLE job(
  seq INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE CHECK(length(id) = 30 AND id GLOB 'job_*'),
  name TEXT NOT NULL,
  state TEXT NOT NULL
    CHECK(state IN ('queued', 'running', 'cancel_requested', 'succeeded', 'failed', 'canceled')),
  reason TEXT NOT NULL DEFAULT '',          -- stable word: why it is in this state
  message TEXT NOT NULL DEFAULT '',         -- a sentence for people
  frame_count INTEGER NOT NULL CHECK(frame_count >= 1),
  fps REAL NOT NULL CHECK(fps > 0),
  input_bytes INTEGER NOT NULL CHECK(input_bytes >= 0),
  key_frame_count INTEGER,                  -- solved frames; NULL before they are known
  stage TEXT,
  stage_fraction REAL NOT NULL DEFAULT 0 CHECK(stage_fraction BETWEEN 0 AND 1),
  fraction REAL NOT NULL DEFAULT 0 CHECK(fraction BETWEEN 0 AND 1),
  progress_message TEXT NOT NULL DEFAULT '',
  best_fraction REAL NOT NULL DEFAULT 0,    -- highest fraction that any attempt reached
  attempt INTEGER NOT NULL DEFAULT 0,
  attempts_without_progress INTEGER NOT NULL DEFAULT 0,
  not_before_ms INTEGER NOT NULL DEFAULT 0, -- no attempt before this time (waiting for disk space)
  lease INTEGER NOT NULL DEFAULT 0,         -- fencing token: only its holder may write for this attempt
  report TEXT,                              -- the worker's last report, as JSON
  version INTEGER NOT NULL DEFAULT 1,
  removing INTEGER NOT NULL DEFAULT 0 CHECK(removing IN (0, 1)), -- files are being deleted, the row goes last
  created_ms INTEGER NOT NULL,
  updated_ms INTEGER NOT NULL,
  started_ms INTEGER,
  finished_ms INTEGER,
  CHECK((finished_ms IS NOT NULL) = (state IN ('succeeded', 'failed', 'canceled')))) STRICT;

CREATE INDEX job_claim ON job(seq) WHERE state = 'queued';
CREATE INDEX job_by_state ON job(state, seq);

CREATE TRIGGER job_step_is_allowed BEFORE UPDATE OF state ON job
WHEN NOT EXISTS (SELECT 1 FROM job_step WHERE from_state = OLD.state AND to_state = NEW.state)
BEGIN
  SELECT RAISE(ABORT, 'step between job states is not allowed');
END;

CREATE TRIGGER job_starts_queued BEFORE INSERT ON job WHEN NEW.state <> 'queued'
BEGIN
  SELECT RAISE(ABORT, 'a job starts queued');
END;

CREATE TABLE job_input(
  job_seq INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE,
  name TEXT NOT NULL,
  role TEXT NOT NULL CHECK(role IN ('scene', 'material', 'texture', 'animation')),
  bytes INTEGER NOT NULL CHECK(bytes >= 0),
  PRIMARY KEY(job_seq, name)) STRICT, WITHOUT ROWID;

-- pid alone may be another process by now; with its start time and the boot it is an identity.
CREATE TABLE attempt(
  job_seq INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE,
  number INTEGER NOT NULL CHECK(number >= 1),
  lease INTEGER NOT NULL,
  started_ms INTEGER NOT NULL,
  ended_ms INTEGER,
  outcome TEXT,                             -- reason word of the step that ended it
  exit_code INTEGER,
  signal INTEGER,
  worker_pid INTEGER,
  worker_start_ticks INTEGER,
  worker_boot_id TEXT,
  PRIMARY KEY(job_seq, number)) STRICT, WITHOUT ROWID;

CREATE TABLE event(
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  job_seq INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE,
  at_ms INTEGER NOT NULL,
  from_state TEXT,                          -- NULL: the job was submitted
  to_state TEXT NOT NULL,
  reason TEXT NOT NULL,
  message TEXT NOT NULL) STRICT;
CREATE INDEX event_by_job ON event(job_seq, id);

CREATE TABLE frame(
  job_seq INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE,
  frame INTEGER NOT NULL CHECK(frame >= 0),
  kind TEXT NOT NULL CHECK(kind IN ('key', 'check', 'interpolated')),
  error REAL,                               -- predicted relative interpolation error; NULL: not known
  PRIMARY KEY(job_seq, frame)) STRICT, WITHOUT ROWID;

CREATE TABLE key_frame_interval(
  job_seq INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE,
  first_frame INTEGER NOT NULL CHECK(first_frame >= 0),
  last_frame INTEGER NOT NULL CHECK(last_frame > first_frame),
  predicted_error REAL,
  observed_error REAL,
  PRIMARY KEY(job_seq, first_frame)) STRICT, WITHOUT ROWID;

CREATE TABLE artefact(
  job_seq INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE,
  path TEXT NOT NULL CHECK(                 -- the same rule as server::is_plain_relative_path
    length(CAST(path AS BLOB)) BETWEEN 1 AND 512 AND
    '/' || path || '/' NOT GLOB '*//*' AND
    '/' || path || '/' NOT GLOB '*/./*' AND
    '/' || path || '/' NOT GLOB '*/../*' AND
    path NOT GLOB '*\*' AND
    path NOT GLOB '*[' || char(1) || '-' || char(31) || char(127) || ']*'),
  media_type TEXT NOT NULL,
  bytes INTEGER NOT NULL CHECK(bytes >= 0),
  sha256 TEXT NOT NULL CHECK(length(sha256) = 64),
  PRIMARY KEY(job_seq, path)) STRICT, WITHOUT ROWID;
