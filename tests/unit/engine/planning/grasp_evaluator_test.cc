#include "engine/planning/grasp_evaluator.h"
#include "engine/planning/perturbed_copies.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// The gripper looks down on a 40 mm box from above.
class GripperOnABox : public ::testing::Test {
 protected:
  const HandShape hand_{workshop::MakeTwoJawGripper()};
  const Solid box_{workshop::MakeBox({0.04, 0.04, 0.04}, 4)};
  const RigidTransform X_OH_{
      Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix(),
      {0, 0, 0.07}};
  const Parameters parameters_{};
};

TEST_F(GripperOnABox, ATextbookGraspIsStable) {
  const EvaluatedGrasp result =
      CloseAndJudge(hand_, X_OH_, Eigen::Vector2d::Zero(), box_, parameters_);
  EXPECT_TRUE(result.ok());
  EXPECT_GT(result.grasp.quality.epsilon, 0.05);
  EXPECT_TRUE(IsReachable(hand_, result.grasp, box_));
  EXPECT_NEAR(result.grasp.approach_O.z(), -1.0, 1e-12);
}

TEST_F(GripperOnABox, FailuresAreTold) {
  RigidTransform X_OH = X_OH_;
  X_OH.translation.z() = 0.03;
  EXPECT_EQ(
      CloseAndJudge(hand_, X_OH, Eigen::Vector2d::Zero(), box_, parameters_)
          .failure,
      GraspFailure::kPalmCollision);
  X_OH.translation = {0.025, 0, 0.07};
  EXPECT_EQ(
      CloseAndJudge(hand_, X_OH, Eigen::Vector2d::Zero(), box_, parameters_)
          .failure,
      GraspFailure::kFingerCollision);
  X_OH.translation = {0, 0, 0.2};
  EXPECT_EQ(
      CloseAndJudge(hand_, X_OH, Eigen::Vector2d::Zero(), box_, parameters_)
          .failure,
      GraspFailure::kNoContact);
}

TEST_F(GripperOnABox, ALidInTheWayMakesItUnreachable) {
  EvaluatedGrasp result =
      CloseAndJudge(hand_, X_OH_, Eigen::Vector2d::Zero(), box_, parameters_);
  const Solid lid(CalcTransformed(
      workshop::MakeBox({0.2, 0.2, 0.01}),
      {Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, 0.12)}));
  EXPECT_FALSE(IsReachable(hand_, result.grasp, lid));
}

TEST_F(GripperOnABox, AFirmGraspIsRobust) {
  const EvaluatedGrasp result =
      CloseAndJudge(hand_, X_OH_, Eigen::Vector2d::Zero(), box_, parameters_);
  // The base stays 30 mm away from the box, the jaws 20 mm: no perturbation of
  // 3 mm and 3 degrees makes it collide.
  EXPECT_GT(CalcRobustness(hand_, result.grasp, box_, parameters_, 1).stable,
            0.5);
}

TEST_F(GripperOnABox, AFirmGraspIsGrippedButNotByWeakMotors) {
  const EvaluatedGrasp result =
      CloseAndJudge(hand_, X_OH_, Eigen::Vector2d::Zero(), box_, parameters_);
  EXPECT_EQ(CalcGrip(hand_, result.grasp, box_.mass(), parameters_), 0.0);
  Parameters weak = parameters_;
  weak.grip.least_force = 0.1;
  weak.motors.closing_force = weak.motors.holding_force = 0.2;
  EXPECT_GT(CalcGrip(hand_, result.grasp, box_.mass(), weak), 0.5);
  const Robustness firm =
      CalcRobustness(hand_, result.grasp, box_, parameters_, 1);
  EXPECT_GT(firm.gripped, 0.5);
  EXPECT_LE(firm.gripped, firm.stable);
  // With so little friction a push along the jaws is withstood, since they
  // meet their stops within 2 cm, and one towards the base; the others are not.
  EXPECT_LT(CalcRobustness(hand_, result.grasp, box_, weak, 1).gripped,
            0.6 * firm.gripped);
  const Robustness unpushed =
      CalcRobustness(hand_, result.grasp, box_, weak, 1, {.pushed = false});
  EXPECT_EQ(unpushed.gripped, firm.gripped);
}

TEST_F(GripperOnABox, PenetrationIsTheDepthOfTheOverlap) {
  HandConfiguration c{X_OH_, Eigen::Vector2d::Zero()};
  EXPECT_EQ(CalcPenetration(hand_, c, box_), 0.0);
  // Both jaws 1.5 mm into the box's sides.
  c.q = Eigen::Vector2d::Constant(0.0215);
  EXPECT_NEAR(CalcPenetration(hand_, c, box_), 0.0015, 1e-5);
}

// A cylinder stands 10 mm off the middle of the three fingers.
TEST(TimeFingers, LetsAllMeetTheObjectTogetherWhereTheyMetIt) {
  const HandShape hand(workshop::LoadBarrettHand());
  const HandModel& model = hand.model();
  const Solid cylinder(workshop::MakeCylinder(0.03, 0.12, 48, 12));
  const RigidTransform X_OH{
      Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()).toRotationMatrix(),
      {-0.115, 0.01, 0.0}};
  const EvaluatedGrasp closed =
      CloseAndJudge(hand, X_OH, Eigen::VectorXd::Zero(model.num_joints()),
                    cylinder, Parameters());
  ASSERT_TRUE(closed.ok());
  const auto calc_travels = [&](const Grasp& grasp) {
    std::vector<double> travels;
    for (const HandActuator& actuator : model.actuators()) {
      if (!actuator.closes) continue;
      const int j = actuator.joints.front();
      travels.push_back(grasp.configuration.q[j] - grasp.q_pregrasp[j]);
    }
    return travels;
  };
  const std::vector<double> before = calc_travels(closed.grasp);
  ASSERT_GT(*std::max_element(before.begin(), before.end()),
            *std::min_element(before.begin(), before.end()) + 0.05);
  const Grasp timed = TimeFingers(hand, closed.grasp, cylinder, Parameters());
  // As open as the finger lets that meets the cylinder first: its motor is at
  // 0.
  const double least = *std::min_element(before.begin(), before.end());
  // To where each finger stops short of the object, some hundredths of a
  // millimetre at its tip.
  for (const double travel : calc_travels(timed)) {
    EXPECT_NEAR(travel, least, 5e-4);
  }
  const EvaluatedGrasp again =
      CloseAndJudge(hand, X_OH, timed.q_pregrasp, cylinder, Parameters());
  ASSERT_TRUE(again.ok());
  EXPECT_LT((again.grasp.configuration.q - closed.grasp.configuration.q)
                .cwiseAbs()
                .maxCoeff(),
            0.01);
}

}  // namespace
}  // namespace graspdb
