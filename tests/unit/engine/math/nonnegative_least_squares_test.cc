#include "engine/math/nonnegative_least_squares.h"

#include <gtest/gtest.h>

#include "engine/base/random.h"

namespace graspdb {
namespace {

TEST(NonnegativeLeastSquares, LeavesOutWhatWouldBeNegative) {
  // Without a bound x = (2, -1); with it x_1 = 0 and x_0 = 2 · 1 / 1 remain.
  Eigen::Matrix2d A = Eigen::Matrix2d::Identity();
  const Eigen::VectorXd x =
      NonnegativeLeastSquares(A).Solve(Eigen::Vector2d(2.0, -1.0));
  EXPECT_NEAR(x[0], 2.0, 1e-8);
  EXPECT_EQ(x[1], 0.0);
}

TEST(NonnegativeLeastSquares, FindsAConicCombinationWhereThereIsOne) {
  // (1, 3) = 2 (0.5, 0.5) + 2 (0, 1), among columns that point elsewhere.
  Eigen::MatrixXd A(2, 4);
  A << 0.5, 0.0, -1.0, 0.3, 0.5, 1.0, 0.2, -0.9;
  const Eigen::Vector2d b(1.0, 3.0);
  const Eigen::VectorXd x = NonnegativeLeastSquares(A).Solve(b);
  EXPECT_GE(x.minCoeff(), 0.0);
  EXPECT_NEAR((A * x - b).norm(), 0.0, 1e-7);
}

// Karush, Kuhn, Tucker: no column at rest would gain, none that moves does.
TEST(NonnegativeLeastSquares, MeetsTheOptimalityConditionsOnRandomProblems) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::MatrixXd A(8, 30);
    Eigen::VectorXd b(8);
    for (auto& a : A.reshaped()) a = random.NextUniform(-1.0, 1.0);
    for (auto& one : b) one = random.NextUniform(-5.0, 5.0);
    if (trial % 2 == 0) A = A.cwiseAbs();  // Some b are then out of reach.
    const NonnegativeLeastSquares problem(A);
    // From nothing, and from what solves another problem.
    const Eigen::VectorXd other = problem.Solve(b.reverse());
    const Eigen::VectorXd x =
        trial % 3 == 0 ? problem.Solve(b, other) : problem.Solve(b);
    const Eigen::VectorXd gain = A.transpose() * (b - A * x);
    EXPECT_GE(x.minCoeff(), 0.0);
    for (int i = 0; i < 30; ++i) {
      EXPECT_LT(gain[i], 1e-6) << trial;
      if (x[i] > 0.0) {
        EXPECT_NEAR(gain[i], 0.0, 1e-6) << trial;
      }
    }
  }
}

}  // namespace
}  // namespace graspdb
