-- How long a finished job is kept, and what it takes on disk, so that quotas can be told without looking at files.
-- Old rows: kept until somebody removes them; their bytes are what came in and what was published.
ALTER TABLE job ADD COLUMN pinned INTEGER NOT NULL DEFAULT 0 CHECK(pinned IN (0, 1)); -- never removed by itself
ALTER TABLE job ADD COLUMN ttl_ms INTEGER CHECK(ttl_ms >= 0);        -- after it finished; NULL: kept
ALTER TABLE job ADD COLUMN bytes INTEGER NOT NULL DEFAULT 0 CHECK(bytes >= 0); -- of its folder, when last looked at
ALTER TABLE job ADD COLUMN expires_ms INTEGER GENERATED ALWAYS AS (finished_ms + ttl_ms) VIRTUAL;

UPDATE job SET bytes = input_bytes + (SELECT coalesce(sum(bytes), 0) FROM artefact WHERE job_seq = seq);

CREATE INDEX job_expiry ON job(expires_ms) WHERE expires_ms IS NOT NULL AND pinned = 0;
CREATE INDEX job_bytes ON job(owner, bytes);
