#pragma once

#include <vector>

#include <Eigen/Core>

namespace graspdb {

/** Points on a mesh's surface, in the mesh's frame M, one entry per point. */
struct SurfaceSamples {
  std::vector<Eigen::Vector3d> points;   ///< On the face, metres.
  std::vector<Eigen::Vector3d> normals;  ///< The face's, unit, outward.
  std::vector<int> faces;                ///< Index of the face.

  int size() const { return static_cast<int>(points.size()); }
  bool operator==(const SurfaceSamples&) const = default;
};

}  // namespace graspdb
