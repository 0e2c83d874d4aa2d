#include "engine/transfer/replan_objective.h"

#include <cmath>

#include "engine/quality/hybrid_measure.h"

namespace graspdb {

double CalcPositionTerm(const std::vector<ContactGoal>& goals,
                        const ReplanParameters& parameters) {
  double sum = 0.0;
  for (const ContactGoal& goal : goals) {
    sum += ((goal.p_NF - goal.p_ND) / parameters.length_unit).squaredNorm();
  }
  return parameters.position_weight * sum;
}

double CalcOppositionTerm(const std::vector<ContactGoal>& goals,
                          const ReplanParameters& parameters) {
  double sum = 0.0;
  for (const ContactGoal& goal : goals) {
    sum += std::exp(parameters.normal_weight * goal.nhat_F.dot(goal.nhat_D));
  }
  return sum;
}

double CalcJointTerm(const Eigen::VectorXd& q, const Eigen::VectorXd& q_example,
                     const ReplanParameters& parameters) {
  double sum = 0.0;
  for (int k = 0; k < q.size(); ++k) {
    const double low = q_example[k] - parameters.joint_range;
    const double up = q_example[k] + parameters.joint_range;
    sum += std::exp(parameters.joint_weight * (low - q[k])) +
           std::exp(parameters.joint_weight * (q[k] - up));
  }
  return sum;
}

double CalcReplanObjective(const std::vector<ContactGoal>& goals,
                           const Eigen::VectorXd& q,
                           const Eigen::VectorXd& q_example, double epsilon,
                           double epsilon_floor,
                           const ReplanParameters& parameters) {
  return CalcPositionTerm(goals, parameters) +
         CalcOppositionTerm(goals, parameters) +
         CalcJointTerm(q, q_example, parameters) +
         CalcQualityTerm(epsilon, parameters.quality_weight, epsilon_floor);
}

}  // namespace graspdb
