#include "engine/geometry/collision_shape.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

RigidTransform Turn(double angle, const Eigen::Vector3d& axis) {
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(),
          Eigen::Vector3d::Zero()};
}

RigidTransform Shift(const Eigen::Vector3d& p) {
  return {Eigen::Matrix3d::Identity(), p};
}

class TwoBoxes : public ::testing::Test {
 protected:
  const CollisionShape a_{workshop::MakeBox({0.02, 0.02, 0.02})};
  const CollisionShape b_{workshop::MakeBox({0.04, 0.04, 0.04})};
};

TEST_F(TwoBoxes, MeetUntilTheirFacesAreApart) {
  EXPECT_TRUE(a_.Intersects(b_, Shift({0.0299, 0.001, 0.002})));
  EXPECT_FALSE(a_.Intersects(b_, Shift({0.0301, 0.001, 0.002})));
  EXPECT_FALSE(b_.Intersects(a_, Shift({0.0, 0.001, -0.0301})));
}

TEST_F(TwoBoxes, MeetUntilTwoEdgesAreApart) {
  // A's edge along x below B's along y: sqrt(2) of half a side from the middle.
  const double touch = std::sqrt(2.0) * (0.01 + 0.02);
  const RigidTransform X_AW = Turn(-M_PI / 4.0, Eigen::Vector3d::UnitX());
  const RigidTransform X_B = Turn(M_PI / 4.0, Eigen::Vector3d::UnitY());
  EXPECT_TRUE(a_.Intersects(b_, X_AW * (Shift({0, 0, touch - 1e-4}) * X_B)));
  EXPECT_FALSE(a_.Intersects(b_, X_AW * (Shift({0, 0, touch + 1e-4}) * X_B)));
}

TEST_F(TwoBoxes, DoNotMeetWhenOneIsWhollyInside) {
  EXPECT_FALSE(a_.Intersects(b_, Shift({0.001, 0.002, 0.003})));
}

TEST(CollisionShape, MeetsWhereFclSaysSo) {
  const CollisionShape mug(workshop::LoadMug("latte").mesh_O);
  const CollisionShape box(workshop::MakeBox({0.02, 0.03, 0.05}, 4));
  Random random(1);
  int meets = 0;
  constexpr int kPoses = 4000;
  for (int i = 0; i < kPoses; ++i) {
    const RigidTransform X_MB{random.NextRotation(),
                              0.09 * random.NextInUnitBall()};
    const bool ours = mug.Intersects(box, X_MB);
    EXPECT_EQ(ours, mug.IntersectsByFcl(box, X_MB));
    EXPECT_EQ(ours, box.Intersects(mug, X_MB.Inverse()));
    meets += ours;
  }
  EXPECT_GT(meets, kPoses / 5);
  EXPECT_LT(meets, 4 * kPoses / 5);
}

// Boxes are compared in single precision, which says apart of none that is not.
TEST(CollisionShape, MeetsWhereFclSaysSoFarFromTheOrigins) {
  Random random(5);
  for (const double far : {1.0, 30.0, 1000.0}) {
    const Eigen::Vector3d p_MA = far * random.NextUnitVector();
    const CollisionShape box(
        CalcTransformed(workshop::MakeBox({0.02, 0.03, 0.05}, 4), Shift(p_MA)));
    const CollisionShape ball(workshop::MakeSphere(0.03, 8));
    int meets = 0;
    constexpr int kPoses = 500;
    for (int i = 0; i < kPoses; ++i) {
      const RigidTransform X_MB{random.NextRotation(),
                                p_MA + 0.07 * random.NextInUnitBall()};
      const bool ours = box.Intersects(ball, X_MB);
      EXPECT_EQ(ours, box.IntersectsByFcl(ball, X_MB)) << far << " " << i;
      meets += ours;
    }
    EXPECT_GT(meets, kPoses / 5);
    EXPECT_LT(meets, 4 * kPoses / 5);
  }
}

// Links are unions of convex pieces that overlap.
TEST(CollisionShape, LinksMeetWhereFclSaysSo) {
  const auto hand = workshop::LoadBarrettHand();
  std::vector<TriangleMesh> meshes;
  std::vector<CollisionShape> links;
  for (const HandLink& link : hand->links()) {
    if (link.pieces_L.empty()) continue;
    meshes.push_back(CalcUnion(link.pieces_L));
    links.emplace_back(meshes.back());
  }
  Random random(2);
  int meets = 0;
  constexpr int kPoses = 4000;
  for (int i = 0; i < kPoses; ++i) {
    const int a = random.NextIndex(static_cast<int>(links.size()));
    const int b = random.NextIndex(static_cast<int>(links.size()));
    // A corner of one within 4 cm of a corner of the other.
    const auto draw = [&](int link) {
      const auto& corners = meshes[link].vertices();
      return corners[random.NextIndex(static_cast<int>(corners.size()))];
    };
    RigidTransform X_AB{random.NextRotation(), Eigen::Vector3d::Zero()};
    X_AB.translation =
        draw(a) + 0.04 * random.NextInUnitBall() - X_AB * draw(b);
    const bool ours = links[a].Intersects(links[b], X_AB);
    EXPECT_EQ(ours, links[a].IntersectsByFcl(links[b], X_AB)) << i;
    meets += ours;
  }
  EXPECT_GT(meets, kPoses / 5);
  EXPECT_LT(meets, 4 * kPoses / 5);
}

}  // namespace
}  // namespace graspdb
