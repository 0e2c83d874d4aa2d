#pragma once

#include <optional>
#include <vector>

#include "engine/geometry/collision_shape.h"
#include "engine/hand/hand_shape.h"
#include "engine/segmentation/part.h"

namespace graspdb {

/** The surfaces of an object's parts, by label, to tell how far a hand keeps
 off each. Immutable, shared by threads. */
class PartSurfaces {
 public:
  /** An object without labels has no parts. */
  explicit PartSurfaces(const LabelledMesh& object);

  /** Per label the gap between the hand and that part's surface, m: 0 where
   they touch or cross, infinite where the object has no such part. */
  std::vector<double> CalcClearances(
      const HandShape& hand, const HandConfiguration& configuration) const;

 private:
  std::vector<std::optional<CollisionShape>> surfaces_;
};

/** Whether the hand keeps at least min_clearance off each of these labels.
 @param clearances  From PartSurfaces; labels beyond it are free. */
bool KeepsFree(const std::vector<double>& clearances,
               const std::vector<int>& labels, double min_clearance);

}  // namespace graspdb
