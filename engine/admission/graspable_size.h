#pragma once

#include "engine/base/result.h"
#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** Refuses what no hand could be meant to grasp, which is nearly always a mesh
 in another unit: the largest side of the box must be 5 mm to 2 m.
 @param mesh  In metres, after the scale.
 @param metres_per_unit  The scale that was applied. @pre Positive.
 @retval kUnusableInput with a hint that names the likely unit and the request
   field `units`. */
Result<void> CheckGraspableSize(const TriangleMesh& mesh,
                                double metres_per_unit);

}  // namespace graspdb
