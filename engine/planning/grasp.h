#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/hand/hand_model.h"
#include "engine/quality/contact.h"

namespace graspdb {

/** How good a grasp is, about one reference object (a part or a whole). */
struct GraspQuality {
  double epsilon{0.0};  ///< Ferrari-Canny, L1, dimensionless; > 0 holds.
  double volume{0.0};   ///< Of the grasp wrench space's hull.
  double hybrid{0.0};   ///< Eq. (1); lower is better.

  bool operator==(const GraspQuality&) const = default;
};

/** Shares of perturbed copies of a grasp, 0..1. */
struct Robustness {
  double stable{0.0};   ///< Those that stay stable …
  double gripped{0.0};  ///< … and those of them that the motors hold, too.

  bool operator==(const Robustness&) const = default;
};

/** A closed, stable, collision-free hand on an object, and how to get there:
 move the hand with joints q_pregrasp along approach_O by retreat to X_OH, then
 close until the fingers stop at configuration.q. */
struct Grasp {
  HandConfiguration configuration;
  Eigen::VectorXd q_pregrasp;  ///< Joints before closing.
  Eigen::Vector3d approach_O{Eigen::Vector3d::UnitZ()};  ///< Unit.
  double retreat{0.0};  ///< Free travel before X_OH along approach_O, m.
  std::vector<Contact> contacts;
  GraspQuality quality;

  bool operator==(const Grasp&) const = default;
};

}  // namespace graspdb
