#include "engine/geometry/surface_patch.h"

#include <algorithm>

namespace graspdb {

SurfacePatch MakeSurfacePatch(const std::array<Eigen::Vector3d, 3>& corners) {
  SurfacePatch patch;
  patch.corners = corners;
  patch.p = (corners[0] + corners[1] + corners[2]) / 3.0;
  for (const Eigen::Vector3d& p : corners) {
    patch.radius = std::max(patch.radius, (p - patch.p).norm());
  }
  return patch;
}

std::array<SurfacePatch, 2> SplitPatch(const SurfacePatch& patch) {
  const std::array<Eigen::Vector3d, 3>& p = patch.corners;
  const auto squared_edge = [&p](int k) {
    return (p[(k + 1) % 3] - p[k]).squaredNorm();
  };
  int k = 0;
  for (int i = 1; i < 3; ++i) {
    if (squared_edge(i) > squared_edge(k)) k = i;
  }
  const Eigen::Vector3d middle = 0.5 * (p[k] + p[(k + 1) % 3]);
  return {MakeSurfacePatch({p[k], middle, p[(k + 2) % 3]}),
          MakeSurfacePatch({middle, p[(k + 1) % 3], p[(k + 2) % 3]})};
}

}  // namespace graspdb
