#include "engine/segmentation/loop_filling.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

bool AllowAll(int, int) { return false; }

// The sum of the triangles' area vectors: for a closed loop it depends on the
// loop only, so that it tells direction and flat area.
Eigen::Vector3d CalcAreaVector(const std::vector<Eigen::Vector3d>& loop,
                               const std::vector<Eigen::Vector3i>& triangles) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3i& t : triangles) {
    sum += 0.5 * (loop[t[1]] - loop[t[0]]).cross(loop[t[2]] - loop[t[0]]);
  }
  return sum;
}

double CalcArea(const std::vector<Eigen::Vector3d>& loop,
                const std::vector<Eigen::Vector3i>& triangles) {
  double sum = 0.0;
  for (const Eigen::Vector3i& t : triangles) {
    sum +=
        0.5 * (loop[t[1]] - loop[t[0]]).cross(loop[t[2]] - loop[t[0]]).norm();
  }
  return sum;
}

TEST(FillLoop, CoversAFlatHollowedLoopExactlyOnce) {
  // An L of area 3; a fan from a corner would leave it.
  const std::vector<Eigen::Vector3d> loop{{0, 0, 0}, {2, 0, 0}, {2, 1, 0},
                                          {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  const auto triangles = FillLoop(loop, AllowAll);
  ASSERT_TRUE(triangles);
  EXPECT_EQ(triangles->size(), 4u);
  EXPECT_NEAR(CalcArea(loop, *triangles), 3.0, 1e-12);
  EXPECT_TRUE(CalcAreaVector(loop, *triangles)
                  .isApprox(Eigen::Vector3d(0, 0, 3), 1e-12));
}

TEST(FillLoop, FindsTheLeastAreaOfABentLoop) {
  // A unit square with one corner lifted.
  const std::vector<Eigen::Vector3d> loop{
      {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const auto triangles = FillLoop(loop, AllowAll);
  ASSERT_TRUE(triangles);
  // Half the flat square plus the triangle (0, 1, 3): √2 · √1.5 / 2.
  EXPECT_NEAR(CalcArea(loop, *triangles),
              0.5 + 0.5 * std::sqrt(2.0) * std::sqrt(1.5), 1e-12);
}

TEST(FillLoop, AvoidsForbiddenChords) {
  const std::vector<Eigen::Vector3d> square{
      {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (const int low : {0, 1}) {
    const auto triangles = FillLoop(
        square, [low](int i, int j) { return i == low && j == low + 2; });
    ASSERT_TRUE(triangles);
    for (const Eigen::Vector3i& t : *triangles) {
      EXPECT_NE((t.array() == low).any() && (t.array() == low + 2).any(), true);
    }
  }
  EXPECT_FALSE(FillLoop(square, [](int, int) { return true; }));
}

TEST(FillLoop, MakesNoSliversOfARing) {
  std::vector<Eigen::Vector3d> ring;
  for (int i = 0; i < 24; ++i) {
    const double phi = 2 * std::numbers::pi * i / 24;
    ring.emplace_back(std::cos(phi), std::sin(phi), 0);
  }
  const auto triangles = FillLoop(ring, AllowAll);
  ASSERT_TRUE(triangles);
  EXPECT_EQ(triangles->size(), 22u);
  for (const Eigen::Vector3i& t : *triangles) {
    // No thinner than the ear that three neighbours on the ring form.
    EXPECT_GT(CalcArea(ring, {t}),
              0.5 * std::pow(2 * std::numbers::pi / 24, 3) * 0.9);
  }
}

TEST(FillLoop, ReturnsATriangleAsItIs) {
  const auto triangles = FillLoop({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, AllowAll);
  ASSERT_TRUE(triangles);
  ASSERT_EQ(triangles->size(), 1u);
  EXPECT_EQ(triangles->front(), Eigen::Vector3i(0, 1, 2));
  EXPECT_THROW(FillLoop({{0, 0, 0}, {1, 0, 0}}, AllowAll), ContractViolation);
}

}  // namespace
}  // namespace graspdb
