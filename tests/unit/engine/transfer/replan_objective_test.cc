#include "engine/transfer/replan_objective.h"

#include <cmath>

#include <gtest/gtest.h>

namespace graspdb {
namespace {

TEST(ReplanObjective, PositionTermCountsSquareCentimetres) {
  // 20 mm off: μ₁ · 2² = 40.
  const std::vector<ContactGoal> goals{
      {{0, 0, 0.02}, {0, 0, -1}, {0, 0, 0}, {0, 0, 1}}};
  EXPECT_NEAR(CalcPositionTerm(goals, {}), 40.0, 1e-12);
}

TEST(ReplanObjective, OppositionTermIsLeastForOpposedNormals) {
  std::vector<ContactGoal> goals{{{0, 0, 0}, {0, 0, -1}, {0, 0, 0}, {0, 0, 1}}};
  EXPECT_NEAR(CalcOppositionTerm(goals, {}), std::exp(-5.0), 1e-12);
  goals[0].nhat_F = {1, 0, 0};
  EXPECT_NEAR(CalcOppositionTerm(goals, {}), 1.0, 1e-12);
}

TEST(ReplanObjective, JointTermGrowsBeyondTheInterval) {
  ReplanParameters parameters;
  parameters.joint_range = 0.2;
  // At the example: 2 e^{-5·0.2}; at its upper bound: e^{-5·0.4} + 1.
  EXPECT_NEAR(CalcJointTerm(Eigen::VectorXd::Constant(1, 1.0),
                            Eigen::VectorXd::Constant(1, 1.0), parameters),
              2 * std::exp(-1.0), 1e-12);
  EXPECT_NEAR(CalcJointTerm(Eigen::VectorXd::Constant(1, 1.2),
                            Eigen::VectorXd::Constant(1, 1.0), parameters),
              std::exp(-2.0) + 1.0, 1e-12);
}

TEST(ReplanObjective, IsTheSumOfItsTerms) {
  const std::vector<ContactGoal> goals{
      {{0, 0, 0.01}, {0, 0, -1}, {0, 0, 0}, {0, 0, 1}}};
  ReplanParameters parameters;
  parameters.joint_range = 0.2;
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 1.0);
  // 10 + e^{-5} + 2 e^{-1} + 20 lg(1/0.1).
  EXPECT_NEAR(CalcReplanObjective(goals, q, q, 0.1, 1e-3, parameters),
              10.0 + std::exp(-5.0) + 2 * std::exp(-1.0) + 20.0, 1e-12);
}

}  // namespace
}  // namespace graspdb
