-- Parts that the hand keeps off in a task, and why.
CREATE TABLE category_keep_free (
  category TEXT NOT NULL,
  label TEXT NOT NULL,
  task TEXT NOT NULL,
  note TEXT NOT NULL,
  PRIMARY KEY (category, label, task),
  FOREIGN KEY (category, label)
    REFERENCES category_parts (category, label) ON DELETE CASCADE
) STRICT, WITHOUT ROWID;

-- The gap, m, between the hand and each other part of the grasp's object.
CREATE TABLE grasp_clearances (
  grasp_id TEXT NOT NULL REFERENCES grasps (id) ON DELETE CASCADE,
  part_label TEXT NOT NULL,
  distance REAL NOT NULL,
  PRIMARY KEY (grasp_id, part_label)
) STRICT, WITHOUT ROWID;

-- Parts that the hand had to keep off in a transfer.
CREATE TABLE transfer_keep_free (
  transfer_id TEXT NOT NULL REFERENCES transfers (id) ON DELETE CASCADE,
  part_label TEXT NOT NULL,
  PRIMARY KEY (transfer_id, part_label)
) STRICT, WITHOUT ROWID;
