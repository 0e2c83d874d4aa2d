#pragma once

#include <vector>

#include "engine/geometry/triangle_mesh.h"
#include "engine/hand/hand_shape.h"
#include "engine/math/rigid_transform.h"
#include "engine/parameters/grasp_parameters.h"
#include "engine/quality/contact.h"

namespace graspdb {

/** Whether a hand can hold what eps says could be held. Eps lets every contact
 press as it likes; a finger presses as its motor drives it. Sought are contact
 forces within the friction cones (friction times grip.friction_share) that keep
 the object at rest, while every closing joint that a contact loads bears what a
 motor lets it bear, as a force at its farthest point: grip.least_force to
 motors.closing_force when the fingers have just closed, or up to
 motors.holding_force, which its worm gear stands, when it has locked while its
 motor goes on to turn an outer joint, and against a push of grip.push at the
 mass centre. Joints that do not close and the base bear anything.
 @param enough  Once the residual is known to exceed this, any value above it.
 @returns what stays unbalanced, N, joints and object together (torques over the
   object's largest radius), in the worst of the seven cases: closed, and pushed
   along ±x, ±y, ±z of O. 0 when all are withstood; 1 or more with fewer than
 two contacts. [after Prattichizzo and Trinkle 2008] */
double CalcGripResidual(const HandShape& hand, const RigidTransform& X_OH,
                        const std::vector<RigidTransform>& X_HL,
                        const std::vector<Contact>& contacts,
                        const MassProperties& mass,
                        const ContactParameters& contact_parameters,
                        const GripParameters& parameters,
                        const MotorParameters& motors, double enough = 1e300);

/** What rounding leaves of a residual of 0, N. */
inline constexpr double kNoGripResidual = 1e-3;

}  // namespace graspdb
