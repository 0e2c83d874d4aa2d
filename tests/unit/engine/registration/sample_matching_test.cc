#include "engine/registration/sample_matching.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/contract.h"
#include "engine/base/random.h"

namespace graspdb {
namespace {

SurfaceSamples MakeRandomSamples(int count, uint64_t seed) {
  Random random(seed);
  SurfaceSamples samples;
  for (int i = 0; i < count; ++i) {
    samples.points.push_back(random.NextInUnitBall());
    samples.normals.push_back(random.NextUnitVector());
    samples.faces.push_back(i);
  }
  return samples;
}

TEST(AffineMap, KeepsNormalsAtRightAnglesToTheSurface) {
  // The plane x + y = 0, stretched by 2 along x: x / 2 + y = 0.
  const AffineMap map{Eigen::Vector3d(2, 1, 1).asDiagonal(), {5, 5, 5}};
  const Eigen::Vector3d normal =
      map.MapNormal(Eigen::Vector3d(1, 1, 0).normalized());
  EXPECT_TRUE(normal.isApprox(Eigen::Vector3d(0.5, 1, 0).normalized(), 1e-14));
}

TEST(AffineMap, OfAProductIsOneMapAfterTheOther) {
  AffineMap a{Eigen::Vector3d(2, 3, 4).asDiagonal(), {1, 0, -1}};
  a.linear(0, 1) = 5.0;
  const AffineMap b{Eigen::Vector3d(1, -1, 2).asDiagonal(), {0, 7, 0}};
  const Eigen::Vector3d p(1, 2, 3);
  EXPECT_TRUE(((a * b) * p).isApprox(a * (b * p), 1e-12));
}

TEST(NormalizedSamples, AreCentredWithUnitRmsRadius) {
  SurfaceSamples samples;
  samples.points = {{1, 0, 0}, {5, 0, 0}, {3, 4, 0}, {3, -4, 0}};
  samples.normals.assign(4, Eigen::Vector3d::UnitZ());
  samples.faces.assign(4, 0);
  // Mean (3, 0, 0); squared radii 4, 4, 16, 16; their mean 10.
  const NormalizedSamples normalized(samples);
  EXPECT_TRUE(normalized.centre.isApprox(Eigen::Vector3d(3, 0, 0)));
  EXPECT_NEAR(normalized.radius, std::sqrt(10.0), 1e-15);
  EXPECT_NEAR(normalized.points(1, 2), 4 / std::sqrt(10.0), 1e-15);
  EXPECT_EQ(NormalizedSamples(samples, 2.0).points(1, 2), 2.0);
}

TEST(NormalizedSamples, RefusePointsThatAllCoincide) {
  SurfaceSamples samples;
  samples.points.assign(3, Eigen::Vector3d::Ones());
  samples.normals.assign(3, Eigen::Vector3d::UnitZ());
  EXPECT_THROW(NormalizedSamples{samples}, ContractViolation);
  EXPECT_THROW(NormalizedSamples{SurfaceSamples()}, ContractViolation);
}

TEST(MatchSamples, FindsTheNearestInSixDimensionsBothWays) {
  const NormalizedSamples E(MakeRandomSamples(101, 1));
  const NormalizedSamples N(MakeRandomSamples(203, 2));
  const AffineMap map{Eigen::Vector3d(1.2, 0.9, 1.0).asDiagonal(),
                      {0.1, 0.0, -0.2}};
  const double weight = 0.4;
  const SampleMatches matches = MatchSamples(E, N, map, weight);
  const auto squared = [&](int i, int j) {
    return (map * E.points.col(i) - N.points.col(j)).squaredNorm() +
           weight * weight *
               (map.MapNormal(E.normals.col(i)) - N.normals.col(j))
                   .squaredNorm();
  };
  ASSERT_EQ(matches.N_of_E.size(), 101u);
  ASSERT_EQ(matches.E_of_N.size(), 203u);
  for (int i = 0; i < 101; ++i) {
    EXPECT_NEAR(matches.squared_E[i], squared(i, matches.N_of_E[i]), 1e-5);
    for (int j = 0; j < 203; ++j) {
      EXPECT_GT(squared(i, j), matches.squared_E[i] - 1e-5);
      EXPECT_GT(squared(i, j), matches.squared_N[j] - 1e-5);
    }
  }
}

TEST(CalcResidual, AveragesBothDirectionsAndCapsEachDistance) {
  SampleMatches matches;
  matches.squared_E = {0.1, 2.0};  // Capped at 0.5: mean 0.3.
  matches.squared_N = {0.1};
  EXPECT_NEAR(CalcResidual(matches), 0.2, 1e-15);
}

TEST(CalcRobustWeight, IsOneForAPerfectMatchAndFallsWithTheDistance) {
  EXPECT_EQ(CalcRobustWeight(0.0), 1.0);
  EXPECT_NEAR(CalcRobustWeight(0.3), 0.25, 1e-15);
  EXPECT_LT(CalcRobustWeight(3.0), 0.01);
}

}  // namespace
}  // namespace graspdb
