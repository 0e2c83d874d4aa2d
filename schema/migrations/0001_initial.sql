-- The first schema: everything that graspdb keeps, in SI units.
-- Append-only: never edit a released migration, add the next number instead.
-- Each file runs in one transaction, which sets user_version to its number, too.
-- Blobs are described in schema/README.md. Times are RFC 3339 UTC text.
-- A seed is an unsigned 64-bit number stored as the signed one with its bits.

PRAGMA application_id = 0x47524442;  -- 'GRDB'

CREATE TABLE categories (
  name TEXT PRIMARY KEY,
  title TEXT NOT NULL,
  created_at TEXT NOT NULL
) STRICT;

CREATE TABLE category_parts (
  category TEXT NOT NULL REFERENCES categories (name) ON DELETE CASCADE,
  label_index INTEGER NOT NULL CHECK (label_index >= 0),
  label TEXT NOT NULL,
  PRIMARY KEY (category, label_index),
  UNIQUE (category, label)
) STRICT, WITHOUT ROWID;

CREATE TABLE category_tasks (
  category TEXT NOT NULL,
  label TEXT NOT NULL,
  task TEXT NOT NULL,
  note TEXT NOT NULL,
  PRIMARY KEY (category, label, task),
  FOREIGN KEY (category, label) REFERENCES category_parts (category, label)
    ON DELETE CASCADE
) STRICT, WITHOUT ROWID;

-- Parts that touch, by label index.
CREATE TABLE category_adjacency (
  category TEXT NOT NULL REFERENCES categories (name) ON DELETE CASCADE,
  position INTEGER NOT NULL,
  a INTEGER NOT NULL,
  b INTEGER NOT NULL,
  PRIMARY KEY (category, position)
) STRICT, WITHOUT ROWID;

-- Segmentation settings by the names of GET /v1/parameters.
CREATE TABLE category_settings (
  category TEXT NOT NULL REFERENCES categories (name) ON DELETE CASCADE,
  name TEXT NOT NULL,
  value REAL NOT NULL,
  PRIMARY KEY (category, name)
) STRICT, WITHOUT ROWID;

CREATE TABLE objects (
  id TEXT PRIMARY KEY,
  sha256 TEXT NOT NULL CHECK (length(sha256) = 64),
  role TEXT NOT NULL CHECK (role IN ('example', 'novel')),
  category TEXT REFERENCES categories (name),
  name TEXT NOT NULL,
  file_name TEXT NOT NULL,
  format TEXT NOT NULL,
  units TEXT NOT NULL,
  num_bytes INTEGER NOT NULL,
  num_triangles INTEGER NOT NULL,
  num_work_triangles INTEGER NOT NULL,
  min_x REAL NOT NULL, min_y REAL NOT NULL, min_z REAL NOT NULL,
  max_x REAL NOT NULL, max_y REAL NOT NULL, max_z REAL NOT NULL,
  volume REAL NOT NULL,
  area REAL NOT NULL,
  centre_x REAL NOT NULL, centre_y REAL NOT NULL, centre_z REAL NOT NULL,
  max_radius REAL NOT NULL,
  created_at TEXT NOT NULL
) STRICT;
-- The same upload is stored once.
CREATE UNIQUE INDEX objects_by_content
  ON objects (sha256, units, role, ifnull(category, ''));
CREATE INDEX objects_by_category ON objects (category, role, id);

CREATE TABLE object_data (
  object_id TEXT PRIMARY KEY REFERENCES objects (id) ON DELETE CASCADE,
  bytes BLOB NOT NULL,             -- the file as uploaded
  canonical_mesh BLOB NOT NULL,
  work_mesh BLOB,                  -- NULL: the same as canonical_mesh
  canonical_labels BLOB,           -- NULL: not segmented
  work_labels BLOB                 -- NULL: the same as canonical_labels
) STRICT;

-- Repairs done at import ('repair') and warnings of the segmentation
-- ('warning'), in order.
CREATE TABLE object_notes (
  object_id TEXT NOT NULL REFERENCES objects (id) ON DELETE CASCADE,
  kind TEXT NOT NULL CHECK (kind IN ('repair', 'warning')),
  position INTEGER NOT NULL,
  note TEXT NOT NULL,
  PRIMARY KEY (object_id, kind, position)
) STRICT, WITHOUT ROWID;

-- How an object came by its labels; X_NE and scale lay the example on it.
CREATE TABLE segmentations (
  object_id TEXT PRIMARY KEY REFERENCES objects (id) ON DELETE CASCADE,
  method TEXT NOT NULL
    CHECK (method IN ('labels', 'transfer', 'shape_diameter')),
  verdict TEXT NOT NULL CHECK (verdict IN ('matched', 'unsure', 'foreign')),
  example_id TEXT REFERENCES objects (id) ON DELETE SET NULL,
  pose BLOB NOT NULL,
  scale REAL NOT NULL,
  residual REAL NOT NULL,
  similarity REAL NOT NULL
) STRICT;
CREATE INDEX segmentations_by_example ON segmentations (example_id);

CREATE TABLE parts (
  id TEXT PRIMARY KEY,
  object_id TEXT NOT NULL REFERENCES objects (id) ON DELETE CASCADE,
  label_index INTEGER NOT NULL,
  label TEXT NOT NULL,
  area REAL NOT NULL,
  volume REAL NOT NULL,
  confidence REAL NOT NULL,
  faces BLOB NOT NULL,  -- of the canonical mesh
  solid BLOB NOT NULL,
  UNIQUE (object_id, label_index)
) STRICT;

CREATE TABLE part_adjacency (
  part_id TEXT NOT NULL REFERENCES parts (id) ON DELETE CASCADE,
  label TEXT NOT NULL,  -- of the part of the same object that it touches
  PRIMARY KEY (part_id, label)
) STRICT, WITHOUT ROWID;

CREATE TABLE hands (
  name TEXT PRIMARY KEY,
  title TEXT NOT NULL,
  sha256 TEXT NOT NULL CHECK (length(sha256) = 64),
  urdf TEXT NOT NULL,
  annotations TEXT NOT NULL,  -- hand.json
  created_at TEXT NOT NULL
) STRICT;

CREATE TABLE hand_meshes (
  hand TEXT NOT NULL REFERENCES hands (name) ON DELETE CASCADE,
  position INTEGER NOT NULL,
  file TEXT NOT NULL,  -- as the URDF names it
  mesh BLOB NOT NULL,
  PRIMARY KEY (hand, position)
) STRICT, WITHOUT ROWID;

-- Parameter sets by content; grasp spaces and transfers share them.
CREATE TABLE parameter_sets (
  hash TEXT PRIMARY KEY,
  json TEXT NOT NULL
) STRICT;

CREATE TABLE grasp_spaces (
  id TEXT PRIMARY KEY,
  object_id TEXT NOT NULL REFERENCES objects (id) ON DELETE CASCADE,
  part_id TEXT NOT NULL REFERENCES parts (id) ON DELETE CASCADE,
  part_label TEXT NOT NULL,
  category TEXT NOT NULL REFERENCES categories (name),
  hand TEXT NOT NULL REFERENCES hands (name),
  parameters_hash TEXT NOT NULL REFERENCES parameter_sets (hash),
  seed INTEGER NOT NULL,
  engine_version TEXT NOT NULL,
  num_grasps INTEGER NOT NULL,
  num_support_vectors INTEGER NOT NULL,
  configurations_tried INTEGER NOT NULL,
  coverage REAL NOT NULL,
  seconds REAL NOT NULL,
  created_at TEXT NOT NULL,
  support_vectors BLOB NOT NULL,
  UNIQUE (part_id, hand, parameters_hash, seed)
) STRICT;
CREATE INDEX grasp_spaces_by_object ON grasp_spaces (object_id);
CREATE INDEX grasp_spaces_by_category ON grasp_spaces (category, part_label);
CREATE INDEX grasp_spaces_by_hand ON grasp_spaces (hand);
CREATE INDEX grasp_spaces_by_parameters ON grasp_spaces (parameters_hash);

CREATE TABLE learning_rounds (
  grasp_space_id TEXT NOT NULL REFERENCES grasp_spaces (id) ON DELETE CASCADE,
  position INTEGER NOT NULL,
  samples INTEGER NOT NULL,
  support_vectors INTEGER NOT NULL,
  balanced_accuracy REAL NOT NULL,
  boundary_accuracy REAL NOT NULL,
  PRIMARY KEY (grasp_space_id, position)
) STRICT, WITHOUT ROWID;

CREATE TABLE transfers (
  id TEXT PRIMARY KEY,
  object_id TEXT NOT NULL REFERENCES objects (id) ON DELETE CASCADE,
  example_id TEXT NOT NULL REFERENCES objects (id) ON DELETE CASCADE,
  category TEXT NOT NULL REFERENCES categories (name),
  hand TEXT NOT NULL REFERENCES hands (name),
  stage TEXT NOT NULL CHECK (stage IN ('transfer', 'assembly')),
  sources_per_part INTEGER NOT NULL,
  parameters_hash TEXT NOT NULL REFERENCES parameter_sets (hash),
  seed INTEGER NOT NULL,
  engine_version TEXT NOT NULL,
  similarity REAL NOT NULL,
  complete INTEGER NOT NULL CHECK (complete IN (0, 1)),
  created_at TEXT NOT NULL
) STRICT;
CREATE INDEX transfers_by_object ON transfers (object_id);
CREATE INDEX transfers_by_example ON transfers (example_id);
CREATE INDEX transfers_by_category ON transfers (category);
CREATE INDEX transfers_by_hand ON transfers (hand);
CREATE INDEX transfers_by_parameters ON transfers (parameters_hash);

-- The lists of a transfer: labels of the parts asked for ('part'), warnings
-- ('warning') and how long each stage took ('seconds', its name in note).
CREATE TABLE transfer_notes (
  transfer_id TEXT NOT NULL REFERENCES transfers (id) ON DELETE CASCADE,
  kind TEXT NOT NULL CHECK (kind IN ('part', 'warning', 'seconds')),
  position INTEGER NOT NULL,
  note TEXT NOT NULL,
  value REAL,
  PRIMARY KEY (transfer_id, kind, position)
) STRICT, WITHOUT ROWID;

-- seq gives the order of storing; lists go by (epsilon, seq).
CREATE TABLE grasps (
  seq INTEGER PRIMARY KEY,
  id TEXT NOT NULL UNIQUE,
  stage TEXT NOT NULL CHECK (stage IN ('learned', 'transfer', 'assembly')),
  position INTEGER NOT NULL,  -- among the grasps of its space or transfer
  object_id TEXT NOT NULL REFERENCES objects (id) ON DELETE CASCADE,
  part_id TEXT NOT NULL REFERENCES parts (id) ON DELETE CASCADE,
  part_label TEXT NOT NULL,
  category TEXT NOT NULL REFERENCES categories (name),
  hand TEXT NOT NULL REFERENCES hands (name),
  grasp_space_id TEXT NOT NULL REFERENCES grasp_spaces (id) ON DELETE CASCADE,
  transfer_id TEXT REFERENCES transfers (id) ON DELETE CASCADE,
  source_grasp_id TEXT REFERENCES grasps (id) ON DELETE CASCADE,
  epsilon REAL NOT NULL,
  volume REAL NOT NULL,
  hybrid REAL NOT NULL,
  robust REAL,
  physical REAL,
  example_epsilon REAL NOT NULL,
  open_close_epsilon REAL NOT NULL,
  penetration REAL NOT NULL,
  data BLOB NOT NULL,  -- pose, joints, pre-grasp, contacts, targets
  CHECK ((stage = 'learned') = (transfer_id IS NULL)),
  CHECK ((transfer_id IS NULL) = (source_grasp_id IS NULL))
) STRICT;
-- Each list of GET /v1/grasps runs along one of these, which hold all that it
-- filters by, so that rows are only read for the page itself.
CREATE INDEX grasps_by_category ON grasps (category, epsilon, seq, stage);
CREATE INDEX grasps_by_part
  ON grasps (category, part_label, epsilon, seq, stage);
CREATE INDEX grasps_by_part_and_hand
  ON grasps (category, part_label, hand, epsilon, seq, stage);
CREATE INDEX grasps_by_hand ON grasps (hand, epsilon, seq, stage);
CREATE INDEX grasps_by_object ON grasps (object_id, epsilon, seq, stage);
CREATE INDEX grasps_by_epsilon ON grasps (epsilon, seq, stage);
CREATE INDEX grasps_by_hybrid ON grasps (category, hybrid, seq, stage);
CREATE INDEX grasps_by_robust
  ON grasps (category, ifnull(robust, -1.0), seq, stage);
CREATE INDEX grasps_of_part ON grasps (part_id);
CREATE INDEX grasps_of_space ON grasps (grasp_space_id, transfer_id);
CREATE INDEX grasps_of_transfer ON grasps (transfer_id)
  WHERE transfer_id IS NOT NULL;
CREATE INDEX grasps_of_source ON grasps (source_grasp_id)
  WHERE source_grasp_id IS NOT NULL;

CREATE TABLE contact_maps (
  id TEXT PRIMARY KEY,
  transfer_id TEXT NOT NULL REFERENCES transfers (id) ON DELETE CASCADE,
  position INTEGER NOT NULL,
  example_part_id TEXT NOT NULL REFERENCES parts (id) ON DELETE CASCADE,
  novel_part_id TEXT NOT NULL REFERENCES parts (id) ON DELETE CASCADE,
  part_label TEXT NOT NULL,
  pose BLOB NOT NULL,  -- X_NE
  scale REAL NOT NULL,
  residual REAL NOT NULL,
  mapped_share REAL NOT NULL,
  UNIQUE (transfer_id, position)
) STRICT;
CREATE INDEX contact_maps_by_example_part ON contact_maps (example_part_id);
CREATE INDEX contact_maps_by_novel_part ON contact_maps (novel_part_id);

-- Each source grasp of a transfer and how it ended.
CREATE TABLE transfer_attempts (
  transfer_id TEXT NOT NULL REFERENCES transfers (id) ON DELETE CASCADE,
  position INTEGER NOT NULL,
  source_grasp_id TEXT NOT NULL REFERENCES grasps (id) ON DELETE CASCADE,
  part_id TEXT NOT NULL REFERENCES parts (id) ON DELETE CASCADE,
  part_label TEXT NOT NULL,
  transfer_outcome TEXT NOT NULL,
  assembly_outcome TEXT NOT NULL,
  transferred_grasp_id TEXT REFERENCES grasps (id) ON DELETE CASCADE,
  assembled_grasp_id TEXT REFERENCES grasps (id) ON DELETE CASCADE,
  example_epsilon REAL NOT NULL,
  example_epsilon_whole REAL NOT NULL,
  open_close_epsilon_part REAL NOT NULL,
  open_close_epsilon_whole REAL NOT NULL,
  PRIMARY KEY (transfer_id, position)
) STRICT, WITHOUT ROWID;
CREATE INDEX attempts_by_source ON transfer_attempts (source_grasp_id);
CREATE INDEX attempts_by_part ON transfer_attempts (part_id);
CREATE INDEX attempts_by_transferred
  ON transfer_attempts (transferred_grasp_id);
CREATE INDEX attempts_by_assembled ON transfer_attempts (assembled_grasp_id);

CREATE TABLE jobs (
  id TEXT PRIMARY KEY,
  kind TEXT NOT NULL CHECK (kind IN ('import', 'learn', 'transfer')),
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
  payload BLOB  -- the mesh to import; NULL once the job has finished
) STRICT;
CREATE INDEX jobs_by_state ON jobs (state, slow, id);

-- Answers to requests with an Idempotency-Key, kept for a day.
CREATE TABLE replies (
  key TEXT PRIMARY KEY,
  request_sha256 TEXT NOT NULL,
  status INTEGER NOT NULL,
  headers TEXT NOT NULL,  -- "Name: value" lines
  body BLOB NOT NULL,
  created_at TEXT NOT NULL
) STRICT;
CREATE INDEX replies_by_time ON replies (created_at);
