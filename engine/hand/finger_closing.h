#pragma once

#include <Eigen/Core>

#include "engine/geometry/solid.h"
#include "engine/hand/hand_model.h"
#include "engine/hand/hand_shape.h"

namespace graspdb {

/** How a closed hand is found. */
enum class Precision {
  /** By the distance field alone: for searching. Links may overlap the solid by
   a few tenths of a millimetre. */
  kEstimated,
  /** The exact test has confirmed that the result is free of collision. */
  kExact,
};

/** Closes the fingers from q_start and returns all joints. Every closing motor
 turns at the same speed until its last link is blocked: by the solid, by
 another link, or by its limit. When a link meets the solid, the joints up to it
 stop and the next one goes on at its breakaway ratio, if it has one (the
 Barrett hand's TorqueSwitch). A link that met the solid is within a few tenths
 of a millimetre of it.
 @pre The hand at X_OH with q_start collides with nothing. */
Eigen::VectorXd CloseFingers(const HandShape& hand, const RigidTransform& X_OH,
                             const Eigen::VectorXd& q_start, const Solid& solid,
                             Precision precision = Precision::kExact);

}  // namespace graspdb
