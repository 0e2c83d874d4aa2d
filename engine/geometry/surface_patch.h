#pragma once

#include <array>

#include <Eigen/Core>

namespace graspdb {

/** A small flat triangle of a surface: all of it lies within radius of p. */
struct SurfacePatch {
  std::array<Eigen::Vector3d, 3> corners;  ///< m.
  Eigen::Vector3d p;                       ///< Its centroid, m.
  double radius{0.0};                      ///< m.
};

SurfacePatch MakeSurfacePatch(const std::array<Eigen::Vector3d, 3>& corners);

/** Both halves of a patch, cut through the middle of its longest edge. */
std::array<SurfacePatch, 2> SplitPatch(const SurfacePatch& patch);

}  // namespace graspdb
