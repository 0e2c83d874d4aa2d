#include "engine/pipeline/part_clearance.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// A box of 4 cm whose faces above z = 0 are label 2, the others label 0.
LabelledMesh MakeTwoPartBox() {
  LabelledMesh box{workshop::MakeBox({0.04, 0.04, 0.04}, 8), {}};
  for (int f = 0; f < box.mesh_O.num_triangles(); ++f) {
    box.face_labels.push_back(box.mesh_O.centroid(f).z() > 0.0 ? 2 : 0);
  }
  return box;
}

class Clearance : public testing::Test {
 protected:
  // The lowest point of the open gripper at X_OH = identity.
  double CalcLowest() const {
    double lowest = std::numeric_limits<double>::infinity();
    const auto X_HL = CalcLinkPoses(hand_.model(), q_);
    for (size_t i = 0; i < X_HL.size(); ++i) {
      const auto& link = hand_.link(static_cast<int>(i));
      if (!link) continue;
      lowest = std::min(lowest,
                        CalcTransformed(link->mesh_L, X_HL[i]).box_min().z());
    }
    return lowest;
  }

  const HandShape hand_{workshop::MakeTwoJawGripper()};
  const Eigen::VectorXd q_ = Eigen::Vector2d::Zero();
};

TEST_F(Clearance, IsTheGapToEachPart) {
  // The gripper stands 7 cm above the top face.
  const RigidTransform X_OH{Eigen::Matrix3d::Identity(),
                            {0.0, 0.0, 0.02 + 0.07 - CalcLowest()}};
  const auto clearances =
      PartSurfaces(MakeTwoPartBox()).CalcClearances(hand_, {X_OH, q_});
  ASSERT_EQ(clearances.size(), 3u);
  EXPECT_NEAR(clearances[2], 0.07, 1e-9);
  EXPECT_NEAR(clearances[0], 0.09, 0.011);
  EXPECT_GT(clearances[0], 0.09);
  EXPECT_EQ(clearances[1], std::numeric_limits<double>::infinity());
}

TEST_F(Clearance, IsZeroWhereTheyCross) {
  const RigidTransform X_OH{Eigen::Matrix3d::Identity(),
                            {0.0, 0.0, 0.02 - 0.001 - CalcLowest()}};
  EXPECT_EQ(PartSurfaces(MakeTwoPartBox()).CalcClearances(hand_, {X_OH, q_})[2],
            0.0);
}

TEST_F(Clearance, AnObjectWithoutLabelsHasNoParts) {
  EXPECT_TRUE(PartSurfaces({workshop::MakeBox({0.04, 0.04, 0.04}, 2), {}})
                  .CalcClearances(hand_, {RigidTransform(), q_})
                  .empty());
}

TEST(KeepsFree, AsksOnlyForTheGivenLabels) {
  EXPECT_TRUE(KeepsFree({0.0, 0.02}, {1}, 0.01));
  EXPECT_FALSE(KeepsFree({0.0, 0.02}, {0, 1}, 0.01));
  EXPECT_TRUE(KeepsFree({0.0, 0.02}, {}, 0.01));
  EXPECT_TRUE(KeepsFree({0.0}, {3}, 0.01));
}

}  // namespace
}  // namespace graspdb
