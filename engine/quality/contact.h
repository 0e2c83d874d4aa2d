#pragma once

#include <Eigen/Core>

namespace graspdb {

/** A point where a link of the hand touches the object O. */
struct Contact {
  int link{0};
  Eigen::Vector3d p_O{Eigen::Vector3d::Zero()};      ///< On the object, m.
  Eigen::Vector3d nhat_O{Eigen::Vector3d::UnitZ()};  ///< Out of the object.
  double gap{0.0};  ///< Distance to the link's surface, m, at most 0.5 mm.
  bool seen{true};  ///< False where a point cloud shows no surface.

  bool operator==(const Contact&) const = default;
};

}  // namespace graspdb
