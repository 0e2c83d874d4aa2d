#include "engine/hand/finger_closing.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

TEST(CloseFingers, InTheAirEndsAtTheLimits) {
  const HandShape hand(workshop::MakeTwoJawGripper());
  const Solid far(
      CalcTransformed(workshop::MakeBox({0.02, 0.02, 0.02}),
                      {Eigen::Matrix3d::Identity(), Eigen::Vector3d(1, 0, 0)}));
  const Eigen::VectorXd q =
      CloseFingers(hand, {}, Eigen::Vector2d::Zero(), far);
  // The jaws meet each other in the middle, each after 40 mm.
  EXPECT_NEAR(q[0], 0.04, 1e-4);
  EXPECT_NEAR(q[1], 0.04, 1e-4);
}

TEST(CloseFingers, DistalLinkGoesOnAfterTheInnerOneIsBlocked) {
  const HandShape hand(workshop::LoadBarrettHand());
  // A low block between the fingers meets the med links; the distal links pass
  // over it.
  const Solid block(CalcTransformed(
      workshop::MakeBox({0.08, 0.074, 0.03}),
      {Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, 0.1)}));
  const Eigen::VectorXd q = CloseFingers(
      hand, {}, Eigen::VectorXd::Zero(hand.model().num_joints()), block);
  bool broke_away = false;
  for (const char* finger : {"bh_j1", "bh_j2", "bh_j3"}) {
    const double j2 =
        q[workshop::FindJoint(hand.model(), std::string(finger) + "2_joint")];
    const double j3 =
        q[workshop::FindJoint(hand.model(), std::string(finger) + "3_joint")];
    EXPECT_GE(j3, j2 / 3 - 1e-9);
    broke_away = broke_away || j3 > j2 / 3 + 0.05;
  }
  EXPECT_TRUE(broke_away);
}

// The second solid is a bar so thin that it passes between the probes of a
// link: one that goes on to its limit may not see it.
TEST(CloseFingers, AlwaysEndsFreeOfCollision) {
  const HandShape hand(workshop::LoadBarrettHand());
  for (const Eigen::Vector3d& size :
       {Eigen::Vector3d(0.05, 0.05, 0.1), Eigen::Vector3d(0.004, 0.004, 0.2)}) {
    const Solid solid(workshop::MakeBox(size, 1));
    Random random(31);
    int closed = 0;
    for (int i = 0; i < 1500; ++i) {
      const RigidTransform X_OH{
          random.NextRotation(),
          random.NextUniform(0.05, 0.2) * random.NextUnitVector()};
      Eigen::VectorXd motors(4);
      motors << random.NextUniform(0, M_PI), random.NextUniform(0, 1),
          random.NextUniform(0, 1), random.NextUniform(0, 1);
      const Eigen::VectorXd q_start = hand.model().CalcCoupledJoints(motors);
      const auto X_HL = CalcLinkPoses(hand.model(), q_start);
      if (FindCollidingLink(hand, X_OH, X_HL, solid) >= 0 ||
          FindSelfCollision(hand, X_HL)) {
        continue;
      }
      const auto X_HL_closed =
          CalcLinkPoses(hand.model(), CloseFingers(hand, X_OH, q_start, solid));
      EXPECT_EQ(FindCollidingLink(hand, X_OH, X_HL_closed, solid), -1) << i;
      EXPECT_FALSE(FindSelfCollision(hand, X_HL_closed)) << i;
      ++closed;
    }
    EXPECT_GT(closed, 500);
  }
}

// A joint that mimics backwards is one whose axis the URDF has turned round.
TEST(CloseFingers, AJointThatMimicsBackwardsClosesAsItDoesForwards) {
  const auto barrett = workshop::LoadBarrettHand();
  std::vector<int> outer;
  for (const char* name : {"bh_j13_joint", "bh_j23_joint", "bh_j33_joint"}) {
    outer.push_back(workshop::FindJoint(*barrett, name));
  }
  const HandShape forwards(workshop::TurnRound(*barrett, {}));
  const HandShape backwards(workshop::TurnRound(*barrett, outer));
  const Solid solid(workshop::MakeBox({0.05, 0.05, 0.1}));
  Random random(5);
  int touched = 0;
  for (int i = 0; i < 100; ++i) {
    const RigidTransform X_OH{
        random.NextRotation(),
        random.NextUniform(0.1, 0.2) * random.NextUnitVector()};
    Eigen::VectorXd motors = Eigen::VectorXd::Zero(4);
    motors[0] = random.NextUniform(0, M_PI);
    for (const Precision precision :
         {Precision::kExact, Precision::kEstimated}) {
      const Eigen::VectorXd q = CloseFingers(
          forwards, X_OH, forwards.model().CalcCoupledJoints(motors), solid,
          precision);
      Eigen::VectorXd turned = CloseFingers(
          backwards, X_OH, backwards.model().CalcCoupledJoints(motors), solid,
          precision);
      for (const int j : outer) {
        turned[j] *= -1.0;
        if (q[j] > 0.01 && q[j] < forwards.model().joints()[j].upper - 0.01) {
          ++touched;
        }
      }
      EXPECT_TRUE(turned.isApprox(q, 1e-9)) << i;
    }
  }
  EXPECT_GT(touched, 50);
}

}  // namespace
}  // namespace graspdb
