#pragma once

#include <Eigen/Core>

#include "engine/geometry/solid.h"
#include "engine/hand/hand_shape.h"

namespace graspdb {

/** The first link that collides as FCL alone tells it, or -1: a hand all within
 the solid is not seen.
 @param X_HL  All link poses, from CalcLinkPoses(). */
int FindCollidingLinkByFcl(const HandShape& hand, const RigidTransform& X_OH,
                           const std::vector<RigidTransform>& X_HL,
                           const Solid& solid);

/** Whether two links of the hand meet as FCL alone tells it. */
bool CollidesWithItselfByFcl(const HandShape& hand,
                             const std::vector<RigidTransform>& X_HL);

/** The least distance of any link to the solid, m, by FCL's distance query. */
double CalcDistanceByFcl(const HandShape& hand, const RigidTransform& X_OH,
                         const std::vector<RigidTransform>& X_HL,
                         const Solid& solid);

/** Closes the fingers as CloseFingers() does, but by FCL's tests alone: each
 motor in steps of half a degree until a link meets the solid, then eight
 bisections, then the joint beyond it likewise. Self-collision is not looked at.
 @pre The hand at X_OH with q_start collides with nothing. */
Eigen::VectorXd CloseFingersByFcl(const HandShape& hand,
                                  const RigidTransform& X_OH,
                                  const Eigen::VectorXd& q_start,
                                  const Solid& solid);

}  // namespace graspdb
