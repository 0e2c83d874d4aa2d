#pragma once

#include <vector>

#include "engine/segmentation/face_graph.h"

namespace graspdb {

/** Labels faces at the least sum of face costs and of the costs of links whose
 faces get different labels: alpha expansion (Boykov, Veksler and Zabih 2001),
 exact for two labels, within a factor of two for more.
 @param costs  costs[label][face], not negative, one row per label.
 @param link_costs  One per link, not negative. */
std::vector<int> CutLabels(const std::vector<std::vector<double>>& costs,
                           const std::vector<FaceLink>& links,
                           const std::vector<double>& link_costs);

}  // namespace graspdb
