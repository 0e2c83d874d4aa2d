#include "engine/quality/hybrid_measure.h"

#include <gtest/gtest.h>

namespace graspdb {
namespace {

// One point 30 mm above the object, facing down on it, and one beside it at
// the same height, facing sideways.
std::vector<PointPair> MakePairs() {
  return {{{0, 0, 0.03}, {0, 0, -1}, {0, 0, 0}, {0, 0, 1}},
          {{1, 0, 0.03}, {1, 0, 0}, {1, 0, 0}, {0, 0, 1}}};
}

TEST(HybridMeasure, DistanceTermIsTwentyPerMetre) {
  // 20 / m · (0.03 + 0.03) m.
  EXPECT_NEAR(CalcDistanceTerm(MakePairs(), 20.0), 1.2, 1e-15);
}

TEST(HybridMeasure, NormalTermIsZeroWhereTheHandFacesTheObject) {
  // 1 - cos 0 = 0 for the first, 1 - cos 90° = 1 for the second.
  EXPECT_NEAR(CalcNormalTerm(MakePairs(), 1.0, 0.0005), 1.0, 1e-15);
}

TEST(HybridMeasure, NormalTermUsesTheObjectsNormalAtContact) {
  const std::vector<PointPair> touching{
      {{0, 0, 0.0001}, {0, 0, -1}, {0, 0, 0}, {0, 0, 1}}};
  EXPECT_NEAR(CalcNormalTerm(touching, 1.0, 0.0005), 0.0, 1e-15);
}

TEST(HybridMeasure, QualityTermIsTwentyPerDecade) {
  EXPECT_NEAR(CalcQualityTerm(0.1, 20.0, 1e-3), 20.0, 1e-12);
  EXPECT_NEAR(CalcQualityTerm(0.01, 20.0, 1e-3), 40.0, 1e-12);
}

TEST(HybridMeasure, QualityTermFallsTowardsStability) {
  EXPECT_GT(CalcQualityTerm(-0.5, 20.0, 1e-3),
            CalcQualityTerm(-0.1, 20.0, 1e-3));
  EXPECT_GT(CalcQualityTerm(-0.1, 20.0, 1e-3),
            CalcQualityTerm(0.0, 20.0, 1e-3));
  EXPECT_NEAR(CalcQualityTerm(1e-3, 20.0, 1e-3), 60.0, 1e-12);
}

TEST(HybridMeasure, IsTheSumOfItsTerms) {
  // 1.2 + 1.0 + 20 lg(1/0.1) = 22.2.
  EXPECT_NEAR(CalcHybridGraspMeasure(MakePairs(), 0.1, {}, 0.0005), 22.2,
              1e-12);
}

}  // namespace
}  // namespace graspdb
