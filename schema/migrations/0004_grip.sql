-- Of the seconds that learning took, those of the configuration space.
ALTER TABLE grasp_spaces
  ADD COLUMN configuration_space_seconds REAL NOT NULL DEFAULT 0;

-- The share of perturbed copies that the hand's motors hold, 0..1.
ALTER TABLE grasps ADD COLUMN grip REAL;

-- What is returned first: what a simulator found to hold, then what it has not
-- seen, the surer grip first, then what it found to slip; eps tells the rest
-- apart.
ALTER TABLE grasps ADD COLUMN merit REAL GENERATED ALWAYS AS (
  CASE
    WHEN physical IS NULL THEN ifnull(grip, 0.0)
    WHEN physical = 1.0 THEN 2.0
    ELSE physical - 1.0
  END + 0.03 * min(epsilon, 1.0)
) VIRTUAL;
CREATE INDEX grasps_by_merit ON grasps (category, merit, seq, stage);
