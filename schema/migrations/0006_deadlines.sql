-- Jobs have deadlines and two more kinds, and are told apart by what they carry.
CREATE TABLE jobs_6 (
  id TEXT PRIMARY KEY,
  kind TEXT NOT NULL CHECK (
    kind IN ('import', 'learn', 'transfer', 'segment', 'verify')),
  state TEXT NOT NULL CHECK (
    state IN ('queued', 'running', 'succeeded', 'failed', 'cancelled')),
  -- 1: takes minutes, and is worked on apart from what someone waits for.
  slow INTEGER NOT NULL CHECK (slow IN (0, 1)),
  request TEXT NOT NULL,
  idempotency_key TEXT UNIQUE,
  attempts INTEGER NOT NULL DEFAULT 0,  -- how often it was begun
  progress REAL NOT NULL,
  stage TEXT NOT NULL,
  result_id TEXT,  -- of a transfer or object, which may be deleted meanwhile
  error_code TEXT,
  error_message TEXT,
  error_hint TEXT,
  error_field TEXT,
  created_at TEXT NOT NULL,
  started_at TEXT,
  finished_at TEXT,
  deadline INTEGER,  -- milliseconds of Unix time; NULL: none
  payload_sha256 TEXT,  -- NULL before there were deadlines
  -- The mesh to import, or face labels; NULL once the job has finished.
  payload BLOB
) STRICT;
INSERT INTO jobs_6
  SELECT id, kind, state, slow, request, idempotency_key, attempts, progress,
    stage, result_id, error_code, error_message, error_hint, error_field,
    created_at, started_at, finished_at, NULL, NULL, payload
  FROM jobs;
DROP TABLE jobs;
ALTER TABLE jobs_6 RENAME TO jobs;
CREATE INDEX jobs_by_state ON jobs (state, slow, id);

-- The id of the transfer of the same inputs that tries all sources to an end.
ALTER TABLE transfers ADD COLUMN inputs_id TEXT;
CREATE INDEX transfers_by_inputs ON transfers (inputs_id);
