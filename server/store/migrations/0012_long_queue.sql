-- A long queue is counted for every submission and put in order for whoever asks for a place in it. Neither reads the
-- jobs themselves any more, which lie far apart on the disk: both find all they need in an index. Old rows: as they are.
DROP INDEX job_urgency;
-- The most urgent job of an owner, and what the places in the queue depend on. Without rank_ms: for a generated column
-- SQLite would read the table again.
CREATE INDEX job_urgency ON job(owner, priority, queued_ms, seq, state) WHERE state = 'queued';
DROP INDEX job_by_state;
CREATE INDEX job_by_state ON job(state, removing, seq);
