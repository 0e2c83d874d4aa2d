#include "engine/hand/hand_shape.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

TEST(HandShape, HandBesideASolidIsFreeAndThroughItCollides) {
  const HandShape hand(workshop::LoadBarrettHand());
  const Solid sphere(workshop::MakeSphere(0.03));
  const auto X_HL = CalcLinkPoses(
      hand.model(), Eigen::VectorXd::Zero(hand.model().num_joints()));
  RigidTransform X_OH;
  X_OH.translation = {0, 0, -0.2};
  EXPECT_EQ(FindCollidingLink(hand, X_OH, X_HL, sphere), -1);
  X_OH.translation = {0, 0, -0.06};
  EXPECT_EQ(FindCollidingLink(hand, X_OH, X_HL, sphere), 0);
}

TEST(HandShape, ALinkWhollyInsideTheSolidCollides) {
  const HandShape gripper(workshop::MakeTwoJawGripper());
  const Solid block(workshop::MakeBox({0.5, 0.5, 0.5}));
  EXPECT_TRUE(
      LinkCollides(*gripper.link(1), RigidTransform::Identity(), block));
}

// The field may only prove what the exact test would say, too.
TEST(HandShape, FilteredTestAgreesWithFclAndContainmentAlone) {
  const HandShape hand(workshop::LoadBarrettHand());
  const Solid box(workshop::MakeBox({0.06, 0.04, 0.09}, 6));
  Random random(21);
  int hits = 0;
  for (int i = 0; i < 1500; ++i) {
    const RigidTransform X_OL{random.NextRotation(),
                              0.09 * random.NextInUnitBall()};
    const LinkShape& link = *hand.link(1 + i % 8);
    const bool exact =
        box.shape().IntersectsByFcl(link.shape, X_OL) ||
        box.index().CalcSignedDistance(X_OL * link.mesh_L.vertices()[0]) < 0;
    EXPECT_EQ(LinkCollides(link, X_OL, box), exact) << i;
    hits += exact;
  }
  EXPECT_GT(hits, 200);
  EXPECT_LT(hits, 1300);
}

TEST(HandShape, GapBoundNeverExceedsTheTrueGap) {
  const HandShape hand(workshop::LoadBarrettHand());
  const Solid sphere(workshop::MakeSphere(0.03));
  Random random(22);
  for (int i = 0; i < 300; ++i) {
    const RigidTransform X_OL{random.NextRotation(),
                              0.15 * random.NextInUnitBall()};
    const LinkShape& link = *hand.link(1 + i % 8);
    const Eigen::Vector3d p_L = X_OL.Inverse().translation;
    const double gap = link.index.CalcSignedDistance(p_L) - 0.03;
    const double bound = CalcGapBound(link, X_OL, sphere);
    EXPECT_LE(bound, std::max(gap, 0.0) + 1e-4);
    // Tight near the surface: patches of 3 mm, a field error of about 1.5 mm.
    EXPECT_GT(bound, gap < 0.0 || gap > 0.01 ? -1.0 : gap - 0.009);
  }
}

TEST(HandShape, MotionBoundsHoldForRandomPostures) {
  const HandShape hand(workshop::LoadBarrettHand());
  const HandModel& model = hand.model();
  Random random(23);
  for (int i = 0; i < 300; ++i) {
    Eigen::VectorXd q(model.num_joints());
    for (int j = 0; j < model.num_joints(); ++j) {
      q[j] =
          random.NextUniform(model.joints()[j].lower, model.joints()[j].upper);
    }
    const int j = i % model.num_joints();
    Eigen::VectorXd moved = q;
    moved[j] += 1e-6;
    const auto before = CalcLinkPoses(model, q);
    const auto after = CalcLinkPoses(model, moved);
    for (int link = 0; link < model.num_links(); ++link) {
      for (const Eigen::Vector3d& p : hand.link(link)->mesh_L.vertices()) {
        EXPECT_LE((after[link] * p - before[link] * p).norm(),
                  1e-6 * hand.motion_bound(link, j) * (1 + 1e-4) + 1e-14);
      }
    }
  }
}

}  // namespace
}  // namespace graspdb
