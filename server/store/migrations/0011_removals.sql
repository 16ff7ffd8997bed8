-- A job that was removed leaves word of it, which whoever follows all jobs is told: its row takes its own events with
-- it. Jobs that were removed earlier: nobody is told.
CREATE TABLE removal(
  event_id INTEGER PRIMARY KEY,             -- a number of the table event that no row there has
  at_ms INTEGER NOT NULL,
  job_seq INTEGER NOT NULL,
  job_id TEXT NOT NULL,
  owner TEXT NOT NULL,
  from_state TEXT NOT NULL) STRICT;
