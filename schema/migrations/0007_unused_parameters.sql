-- A parameter set goes with the last grasp space or transfer that used it.
CREATE TRIGGER grasp_spaces_leave_parameters AFTER DELETE ON grasp_spaces
BEGIN
  DELETE FROM parameter_sets WHERE hash = OLD.parameters_hash
    AND NOT EXISTS (SELECT 1 FROM grasp_spaces
      WHERE parameters_hash = OLD.parameters_hash)
    AND NOT EXISTS (SELECT 1 FROM transfers
      WHERE parameters_hash = OLD.parameters_hash);
END;
CREATE TRIGGER transfers_leave_parameters AFTER DELETE ON transfers
BEGIN
  DELETE FROM parameter_sets WHERE hash = OLD.parameters_hash
    AND NOT EXISTS (SELECT 1 FROM grasp_spaces
      WHERE parameters_hash = OLD.parameters_hash)
    AND NOT EXISTS (SELECT 1 FROM transfers
      WHERE parameters_hash = OLD.parameters_hash);
END;
DELETE FROM parameter_sets
  WHERE hash NOT IN (SELECT parameters_hash FROM grasp_spaces)
    AND hash NOT IN (SELECT parameters_hash FROM transfers);
