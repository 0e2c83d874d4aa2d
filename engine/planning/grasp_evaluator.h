#pragma once

#include "engine/geometry/solid.h"
#include "engine/hand/finger_closing.h"
#include "engine/hand/hand_shape.h"
#include "engine/parameters/parameters.h"
#include "engine/planning/grasp.h"

namespace graspdb {

/** Why a hand posture does not become a grasp. */
enum class GraspFailure {
  kNone,
  kPalmCollision,    ///< The base link collides before closing.
  kFingerCollision,  ///< A finger collides before closing.
  kNoContact,        ///< Closing meets too little to hold anything.
  kUnstable,         ///< Closed, but ε is below the limit.
  kUnreachable,      ///< The way from the pre-grasp collides.
};

/** A posture after closing: the grasp as far as it was judged, and what is
 wrong with it. */
struct EvaluatedGrasp {
  Grasp grasp;
  GraspFailure failure{GraspFailure::kNone};

  bool ok() const { return failure == GraspFailure::kNone; }
};

/** Closes the hand at X_OH from q_pregrasp on the solid, finds the contacts and
 ε about the solid's mass centre. Approach and retreat are filled in, not
 checked; hybrid and volume are left at zero.
 @param precision  A grasp that is kept must be exact. */
EvaluatedGrasp CloseAndJudge(const HandShape& hand, const RigidTransform& X_OH,
                             const Eigen::VectorXd& q_pregrasp,
                             const Solid& solid, const Parameters& parameters,
                             Precision precision = Precision::kExact);

/** The wrench-space quality of contacts on an object with these mass
 properties; -1 for fewer than two contacts. */
double CalcEpsilon(const std::vector<Contact>& contacts,
                   const MassProperties& mass,
                   const ContactParameters& parameters);

/** Eq. (1) for a closed grasp on the solid. */
double CalcHybrid(const HandShape& hand, const Grasp& grasp, const Solid& solid,
                  const Parameters& parameters);

/** True when the open hand can come from grasp.retreat away, straight along
 grasp.approach_O, without touching the solid. */
bool IsReachable(const HandShape& hand, const Grasp& grasp, const Solid& solid);

/** The grasp, closed anew with each finger, before, as far from where it meets
 the object as the others: at equal speed all meet it together, and none pushes
 it away. As far as they open, or less where the hand could not come along its
 approach so, or the fingers would end elsewhere; unchanged where nothing does.
 */
Grasp TimeFingers(const HandShape& hand, const Grasp& grasp, const Solid& solid,
                  const Parameters& parameters,
                  Precision precision = Precision::kExact);

/** CalcGripResidual() of a grasp's contacts on an object with these mass
 properties, N. */
double CalcGrip(const HandShape& hand, const Grasp& grasp,
                const MassProperties& mass, const Parameters& parameters,
                double enough = 1e300);

/** The deepest that a point of either surface lies inside the other solid, m,
 surfaces sampled every millimetre near each other; 0 without overlap. */
double CalcPenetration(const HandShape& hand,
                       const HandConfiguration& configuration,
                       const Solid& solid);

}  // namespace graspdb
