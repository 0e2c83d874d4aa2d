#include "engine/geometry/distance_field.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

class FieldOfABox : public ::testing::Test {
 protected:
  const TriangleMesh box_ = workshop::MakeBox({0.06, 0.04, 0.09}, 3);
  const SurfaceIndex index_{box_};
  const DistanceField field_{box_, index_, 64, 0.01};
};

TEST_F(FieldOfABox, NeverPromisesMoreThanTheTrueDistance) {
  Random random(51);
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3d p = 0.12 * random.NextInUnitBall();
    EXPECT_LE(field_.Calc(p) - field_.max_error(),
              index_.CalcSignedDistance(p) + 1e-6);
  }
}

TEST_F(FieldOfABox, IsAccurateNextToTheSurface) {
  Random random(52);
  int near = 0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d p = 0.06 * random.NextInUnitBall();
    const double truth = index_.CalcSignedDistance(p);
    if (std::abs(truth) > field_.cell_size()) continue;
    EXPECT_NEAR(field_.Calc(p), truth, field_.max_error());
    ++near;
  }
  EXPECT_GT(near, 500);
}

TEST_F(FieldOfABox, WhereItIsBelowMinusItsErrorIsInside) {
  Random random(54);
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d p = 0.08 * random.NextInUnitBall();
    if (field_.Calc(p) >= -field_.max_error()) continue;
    EXPECT_LT(index_.CalcSignedDistance(p), 0.0);
    ++inside;
  }
  EXPECT_GT(inside, 500);
}

TEST_F(FieldOfABox, RisesOutOfTheNearestFaceByOneMetrePerMetre) {
  for (const double above : {-0.0015, -0.0005, 0.0, 0.0007, 0.0016}) {
    const Eigen::Vector3d top =
        field_.CalcGradient({0.01, 0.005, 0.045 + above});
    EXPECT_NEAR((top - Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-4) << above;
    const Eigen::Vector3d left =
        field_.CalcGradient({-0.03 - above, 0.002, -0.01});
    EXPECT_NEAR((left + Eigen::Vector3d::UnitX()).norm(), 0.0, 1e-4) << above;
  }
  EXPECT_EQ(field_.CalcGradient({0.0, 0.0, 1.0}), Eigen::Vector3d::Zero());
}

TEST_F(FieldOfABox, FarAwayItIsTheDistanceToTheGrid) {
  const double far = field_.Calc({1.0, 0, 0});
  EXPECT_LE(far, 0.97 + 1e-9);
  EXPECT_GT(far, 0.95);
}

TEST_F(FieldOfABox, IsTheSameForABodyThatStandsSomewhere) {
  Random random(53);
  const double rounding =
      field_.max_error() - 0.5 * std::sqrt(3.0) * field_.cell_size();
  for (int i = 0; i < 2000; ++i) {
    const RigidTransform X_ML{random.NextRotation(),
                              0.2 * random.NextInUnitBall()};
    const Eigen::Vector3d p_M = 0.12 * random.NextInUnitBall();
    EXPECT_NEAR(PosedField(field_, X_ML)(X_ML.Inverse() * p_M),
                field_.Calc(p_M), rounding);
  }
}

}  // namespace
}  // namespace graspdb
