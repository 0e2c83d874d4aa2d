#pragma once

#include <cstdint>
#include <vector>

#include "engine/planning/grasp.h"

namespace graspdb {

/** Which grasps of a space are transferred: `count` indices, drawn by the seed
 equally from each quartile of ε, ascending; all of them when there are fewer.
 @pre `grasps` are sorted by ε, the largest first. */
std::vector<int> DrawSourceGrasps(const std::vector<Grasp>& grasps, int count,
                                  uint64_t seed);

}  // namespace graspdb
