#pragma once

#include <Eigen/Geometry>

namespace graspdb {

/** The pose X_AB of frame B in frame A: p_A = R_AB p_B + p_AB. Metres. */
struct RigidTransform {
  Eigen::Matrix3d rotation{Eigen::Matrix3d::Identity()};  ///< R_AB.
  Eigen::Vector3d translation{Eigen::Vector3d::Zero()};   ///< p_AB, metres.

  static RigidTransform Identity() { return {}; }

  /** X_AC = X_AB * X_BC. */
  RigidTransform operator*(const RigidTransform& X_BC) const {
    return {rotation * X_BC.rotation,
            rotation * X_BC.translation + translation};
  }
  /** p_A = X_AB * p_B. */
  Eigen::Vector3d operator*(const Eigen::Vector3d& p_B) const {
    return rotation * p_B + translation;
  }
  /** X_BA. */
  RigidTransform Inverse() const {
    return {rotation.transpose(), -(rotation.transpose() * translation)};
  }

  bool operator==(const RigidTransform&) const = default;
};

/** The angle of a rotation in [0, π] rad. */
inline double CalcRotationAngle(const Eigen::Matrix3d& R) {
  return Eigen::AngleAxisd(R).angle();
}

}  // namespace graspdb
