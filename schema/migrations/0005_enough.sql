-- Sources were tried only until so many grasps were sure; NULL: all were.
ALTER TABLE transfers ADD COLUMN enough INTEGER CHECK (enough >= 1);
