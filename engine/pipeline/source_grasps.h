#pragma once

#include <cstdint>
#include <vector>

#include "engine/grasp_engine.h"

namespace graspdb {

/** `count` of the indices 0..total-1, drawn by the seed equally from each
 quarter, ascending; all of them when there are fewer. */
std::vector<int> DrawByQuartile(int total, int count, uint64_t seed);

/** Which grasps of a space are transferred: `count` indices, drawn by the seed
 equally from each quartile of ε of the grasps that keep min_clearance off the
 labels in keep_free on their own object. Ascending.
 @pre The grasps are sorted by ε, the largest first. */
std::vector<int> DrawSourceGrasps(const GraspSpace& space,
                                  const std::vector<int>& keep_free,
                                  double min_clearance, int count,
                                  uint64_t seed);

}  // namespace graspdb
