#include "engine/reference/fcl_hand.h"

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "engine/hand/finger_closing.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

class FclHand : public ::testing::Test {
 protected:
  // The palm a hand's length above the origin, looking down at it, turned.
  RigidTransform DrawPose(Random& random) const {
    const Eigen::Matrix3d R_OH = random.NextRotation();
    return {R_OH, -random.NextUniform(0.06, 0.16) *
                      (R_OH * hand_.model().approach_H())};
  }

  const HandShape hand_{workshop::LoadBarrettHand()};
  const Solid mug_{workshop::LoadMug("latte").mesh_O};
  const Eigen::VectorXd open_{
      Eigen::VectorXd::Zero(hand_.model().num_joints())};
};

TEST_F(FclHand, CollidesWhereOurExactTestSaysSo) {
  const auto X_HL = CalcLinkPoses(hand_.model(), open_);
  Random random(1);
  int colliding = 0;
  for (int i = 0; i < 300; ++i) {
    const RigidTransform X_OH = DrawPose(random);
    const int ours = FindCollidingLink(hand_, X_OH, X_HL, mug_);
    EXPECT_EQ(FindCollidingLinkByFcl(hand_, X_OH, X_HL, mug_), ours);
    colliding += ours >= 0;
  }
  EXPECT_GT(colliding, 30);
  EXPECT_LT(colliding, 270);
}

TEST_F(FclHand, IsNoNearerThanOurBoundOfTheGap) {
  const auto X_HL = CalcLinkPoses(hand_.model(), open_);
  Random random(2);
  int free = 0;
  for (int i = 0; i < 20; ++i) {
    const RigidTransform X_OH = DrawPose(random);
    const double distance = CalcDistanceByFcl(hand_, X_OH, X_HL, mug_);
    double bound = 1e300;
    for (int link = 0; link < hand_.model().num_links(); ++link) {
      if (!hand_.link(link)) continue;
      bound = std::min(
          bound, CalcGapBound(*hand_.link(link),
                              X_OH * X_HL[static_cast<size_t>(link)], mug_));
    }
    EXPECT_LE(bound, distance + 1e-9);
    free += distance > 0.0;
  }
  EXPECT_GT(free, 3);
}

TEST_F(FclHand, MeetsItselfWhereOurTestSaysSo) {
  const HandModel& model = hand_.model();
  Random random(3);
  int colliding = 0;
  for (int i = 0; i < 200; ++i) {
    Eigen::VectorXd q(model.num_joints());
    for (int j = 0; j < model.num_joints(); ++j) {
      const HandJoint& joint = model.joints()[static_cast<size_t>(j)];
      q[j] = random.NextUniform(joint.lower, joint.upper);
    }
    const auto X_HL = CalcLinkPoses(model, q);
    const bool ours = FindSelfCollision(hand_, X_HL).has_value();
    EXPECT_EQ(CollidesWithItselfByFcl(hand_, X_HL), ours);
    colliding += ours;
  }
  EXPECT_GT(colliding, 5);
}

// On a post so thick that no finger meets another.
TEST_F(FclHand, ClosesItsFingersWhereOursStop) {
  const Solid post(workshop::MakeCylinder(0.035, 0.3));
  Random random(4);
  for (int i = 0; i < 5; ++i) {
    const RigidTransform X_OH{
        Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix() *
            random.NextRotationWithin(0.1),
        Eigen::Vector3d(0.0, 0.0, random.NextUniform(0.24, 0.26))};
    const Eigen::VectorXd ours = CloseFingers(hand_, X_OH, open_, post);
    const Eigen::VectorXd theirs = CloseFingersByFcl(hand_, X_OH, open_, post);
    EXPECT_GT(ours.maxCoeff(), 0.3);
    EXPECT_LT((ours - theirs).cwiseAbs().maxCoeff(), 0.01) << i;
  }
}

}  // namespace
}  // namespace graspdb
