#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** How a depth camera is imitated. */
struct ScanOptions {
  /** How many points each label gets, by label index. */
  std::vector<int> points_by_label;
  double noise{0.0015};  ///< Standard deviation along each axis, m.
  /** Towards a camera at infinity: only what it sees is scanned. Unset: all
   sides are. */
  std::optional<Eigen::Vector3d> camera_O;
  uint64_t seed{1};
};

/** Points of the surface, uniform in area within each label, with noise.
 Deterministic. Labels whose surface the camera does not see get no points.
 @pre One label per face. */
std::vector<Eigen::Vector3d> ScanSurface(const TriangleMesh& mesh_O,
                                         const std::vector<int>& labels,
                                         const ScanOptions& options);

/** As an .xyz file, metres. */
std::string FormatXyz(const std::vector<Eigen::Vector3d>& points);

}  // namespace graspdb
