#include "engine/base/random.h"

#include <cmath>

#include <gtest/gtest.h>

namespace graspdb {
namespace {

TEST(Random, SameSeedGivesTheSameStream) {
  Random a(7);
  Random b(7);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.NextBits(), b.NextBits());
}

TEST(Random, DerivedSeedsDifferByEveryIndex) {
  EXPECT_NE(DeriveSeed(1, {2, 3}), DeriveSeed(1, {3, 2}));
  EXPECT_NE(DeriveSeed(1, {2}), DeriveSeed(2, {2}));
  EXPECT_NE(DeriveSeed(1, {0}), DeriveSeed(1, {0, 0}));
}

TEST(Random, UniformHasMeanOneHalfAndVarianceOneTwelfth) {
  Random random(3);
  double sum = 0.0, sum_of_squares = 0.0;
  constexpr int kCount = 100'000;
  for (int i = 0; i < kCount; ++i) {
    const double u = random.NextUniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    sum_of_squares += (u - 0.5) * (u - 0.5);
  }
  EXPECT_NEAR(sum / kCount, 0.5, 0.005);
  EXPECT_NEAR(sum_of_squares / kCount, 1.0 / 12.0, 0.002);
}

TEST(Random, NormalHasUnitVariance) {
  Random random(4);
  double sum_of_squares = 0.0;
  constexpr int kCount = 100'000;
  for (int i = 0; i < kCount; ++i) {
    sum_of_squares += std::pow(random.NextNormal(), 2);
  }
  EXPECT_NEAR(sum_of_squares / kCount, 1.0, 0.02);
}

TEST(Random, RotationsAreProperAndHaveTheHaarMeanAngle) {
  Random random(5);
  double sum = 0.0;
  constexpr int kCount = 20'000;
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Matrix3d R = random.NextRotation();
    ASSERT_NEAR(R.determinant(), 1.0, 1e-12);
    sum += Eigen::AngleAxisd(R).angle();
  }
  // The mean angle of a uniform rotation is π/2 + 2/π.
  EXPECT_NEAR(sum / kCount, M_PI / 2 + 2 / M_PI, 0.02);
}

TEST(Random, RotationWithinStaysWithin) {
  Random random(6);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_LE(Eigen::AngleAxisd(random.NextRotationWithin(0.1)).angle(),
              0.1 + 1e-12);
  }
}

}  // namespace
}  // namespace graspdb
