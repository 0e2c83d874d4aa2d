#include "engine/planning/grasp_evaluator.h"

#include <cmath>

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
  EXPECT_GT(CalcRobustness(hand_, result.grasp, box_, parameters_, 1), 0.5);
}

TEST_F(GripperOnABox, PenetrationIsTheDepthOfTheOverlap) {
  HandConfiguration c{X_OH_, Eigen::Vector2d::Zero()};
  EXPECT_EQ(CalcPenetration(hand_, c, box_), 0.0);
  // Both jaws 1.5 mm into the box's sides.
  c.q = Eigen::Vector2d::Constant(0.0215);
  EXPECT_NEAR(CalcPenetration(hand_, c, box_), 0.0015, 1e-5);
}

}  // namespace
}  // namespace graspdb
