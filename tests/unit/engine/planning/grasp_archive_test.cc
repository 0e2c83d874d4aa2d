#include "engine/planning/grasp_archive.h"

#include <gtest/gtest.h>

namespace graspdb {
namespace {

Grasp MakeGrasp(double x, double epsilon) {
  Grasp grasp;
  grasp.configuration.X_OH.translation.x() = x;
  grasp.configuration.q = Eigen::Vector2d::Zero();
  grasp.quality.epsilon = epsilon;
  return grasp;
}

TEST(GraspDifference, AddsPositionAngleAndTheLargestJoint) {
  const Grasp a = MakeGrasp(0.0, 0.1);
  Grasp b = MakeGrasp(0.005, 0.1);
  b.configuration.X_OH.rotation =
      Eigen::AngleAxisd(0.2617993877991494 / 4, Eigen::Vector3d::UnitX())
          .toRotationMatrix();
  b.configuration.q = Eigen::Vector2d(0.02617993877991494, 0.0);
  // 5/10 + 1/4 + 1/10.
  EXPECT_NEAR(CalcGraspDifference(a, b, {}), 0.85, 1e-12);
}

TEST(GraspArchive, OfNearDuplicatesTheBetterStays) {
  GraspArchive archive({});
  EXPECT_TRUE(archive.Insert(MakeGrasp(0.0, 0.1)));
  EXPECT_FALSE(archive.Insert(MakeGrasp(0.005, 0.05)));
  EXPECT_TRUE(archive.Insert(MakeGrasp(0.005, 0.2)));
  EXPECT_EQ(archive.size(), 1);
  EXPECT_EQ(archive.MakeSorted()[0].quality.epsilon, 0.2);
}

TEST(GraspArchive, DistinctGraspsAllStayBestFirst) {
  GraspArchive archive({});
  for (const double x : {0.0, 0.02, 0.04})
    archive.Insert(MakeGrasp(x, x + 0.1));
  const auto sorted = archive.MakeSorted();
  ASSERT_EQ(sorted.size(), 3u);
  EXPECT_GT(sorted[0].quality.epsilon, sorted[2].quality.epsilon);
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = i + 1; j < 3; ++j) {
      EXPECT_GE(CalcGraspDifference(sorted[i], sorted[j], {}), 1.0);
    }
  }
}

}  // namespace
}  // namespace graspdb
