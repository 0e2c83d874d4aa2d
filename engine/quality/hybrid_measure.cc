#include "engine/quality/hybrid_measure.h"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.h"

namespace graspdb {

std::vector<PointPair> FindPointPairs(const HandModel& hand,
                                      const RigidTransform& X_OH,
                                      const std::vector<RigidTransform>& X_HL,
                                      const Solid& solid) {
  std::vector<PointPair> pairs;
  pairs.reserve(hand.contact_points().size());
  for (const HandContactPoint& point : hand.contact_points()) {
    const RigidTransform X_OL = X_OH * X_HL[point.link];
    const Eigen::Vector3d p_OP = X_OL * point.p_L;
    const ClosestPoint c = *solid.index().FindClosest(p_OP);
    pairs.push_back(
        {p_OP, X_OL.rotation * point.nhat_L, c.p_M, c.pseudonormal});
  }
  return pairs;
}

double CalcDistanceTerm(const std::vector<PointPair>& pairs, double weight) {
  double sum = 0.0;
  for (const PointPair& pair : pairs) sum += (pair.p_OC - pair.p_OP).norm();
  return weight * sum;
}

double CalcNormalTerm(const std::vector<PointPair>& pairs, double weight,
                      double tolerance) {
  double sum = 0.0;
  for (const PointPair& pair : pairs) {
    const Eigen::Vector3d towards = pair.p_OC - pair.p_OP;
    const double distance = towards.norm();
    const double cosine = distance > tolerance
                              ? pair.nhat_O.dot(towards) / distance
                              : -pair.nhat_O.dot(pair.nhat_C);
    sum += 1.0 - cosine;
  }
  return weight * sum;
}

double CalcQualityTerm(double epsilon, double weight, double floor) {
  GRASPDB_EXPECTS(floor > 0.0);
  if (epsilon >= floor) return -weight * std::log10(epsilon);
  return weight * (-std::log10(floor) + (floor - epsilon));
}

double CalcHybridGraspMeasure(const std::vector<PointPair>& pairs,
                              double epsilon,
                              const HybridParameters& parameters,
                              double tolerance) {
  return CalcDistanceTerm(pairs, parameters.distance_weight) +
         CalcNormalTerm(pairs, parameters.normal_weight, tolerance) +
         CalcQualityTerm(epsilon, parameters.quality_weight,
                         parameters.epsilon_floor);
}

}  // namespace graspdb
