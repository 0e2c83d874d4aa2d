#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/geometry/triangle_mesh.h"
#include "engine/planning/grasp.h"

namespace graspdb {

/** The 26 directions with coordinates -1, 0 and 1. */
inline constexpr int kNumApproaches = 26;

/** The one nearest to `direction`, in [0, kNumApproaches). */
int FindApproach(const Eigen::Vector3d& direction);

/** How much of what there is to grasp at some grasps reach. */
struct GraspCoverage {
  double approaches{0.0};  ///< Share of the 26 directions that one comes from.
  double pairs{0.0};       ///< Share of (direction, region) pairs, see below.
};

/** Coverage of a part. Its surface falls into eight regions: each of its
 vertices goes to the nearest of eight that lie as far apart as can be. A grasp
 reaches, from its approach direction, the regions that its contacts lie in.
 @pre The mesh has a vertex. */
GraspCoverage CalcGraspCoverage(const std::vector<Grasp>& grasps,
                                const TriangleMesh& part_O);

}  // namespace graspdb
