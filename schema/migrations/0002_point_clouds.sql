-- What a point cloud told of its object; no row for one that came as a mesh.
CREATE TABLE clouds (
  object_id TEXT PRIMARY KEY REFERENCES objects (id) ON DELETE CASCADE,
  num_points INTEGER NOT NULL,
  num_outliers INTEGER NOT NULL,
  spacing REAL NOT NULL,
  noise REAL NOT NULL,
  one_sided INTEGER NOT NULL,
  seen_share REAL NOT NULL,
  points BLOB NOT NULL             -- those that the mesh goes by
) STRICT, WITHOUT ROWID;
