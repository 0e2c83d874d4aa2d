#pragma once

#include <vector>

#include "engine/geometry/solid.h"
#include "engine/hand/hand_model.h"
#include "engine/math/rigid_transform.h"
#include "engine/parameters/grasp_parameters.h"

namespace graspdb {

/** One hand contact point p_i and its closest object point c_i. */
struct PointPair {
  Eigen::Vector3d p_OP;    ///< On the hand, in the object's frame O, m.
  Eigen::Vector3d nhat_O;  ///< Out of the hand.
  Eigen::Vector3d p_OC;    ///< On the object.
  Eigen::Vector3d nhat_C;  ///< Out of the object there.
};

/** Pairs each of the hand's contact points with the object's closest point. */
std::vector<PointPair> FindPointPairs(const HandModel& hand,
                                      const RigidTransform& X_OH,
                                      const std::vector<RigidTransform>& X_HL,
                                      const Solid& solid);

/** ω₁ ∑ |c_i − p_i|. @paper{Eq. (1), first term} */
double CalcDistanceTerm(const std::vector<PointPair>& pairs, double weight);

/** ω₂ ∑ (1 − n_i · (c_i − p_i)/|c_i − p_i|), 0 where the hand faces the object.
 Nearer than `tolerance` the direction is the object's inward normal.
 @paper{Eq. (1), second term} */
double CalcNormalTerm(const std::vector<PointPair>& pairs, double weight,
                      double tolerance);

/** ω₃ lg(1/ε). For ε below `floor`, lg(1/floor) plus how far ε is from it, so
 that the measure falls towards stability. @paper{Eq. (1), third term} */
double CalcQualityTerm(double epsilon, double weight, double floor);

/** The hybrid grasp measure; lower is better. @paper{Eq. (1)} */
double CalcHybridGraspMeasure(const std::vector<PointPair>& pairs,
                              double epsilon,
                              const HybridParameters& parameters,
                              double tolerance);

}  // namespace graspdb
