#include "engine/dynamics/arrow_system.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "engine/base/random.h"

namespace graspdb {
namespace {

TEST(ArrowSystem, SolvesOneJointAndTheBodyByHand) {
  // 2 v + q = 4, v + 3 q = 7 along x: v = 1, q = 2.
  ArrowSystem system(1, {});
  system.body().setIdentity();
  system.body()(0, 0) = 2.0;
  system.coupling(0)[0] = 1.0;
  system.joint(0, 0) = 3.0;
  system.body_right()[0] = 4.0;
  system.right(0) = 7.0;
  Eigen::VectorXd x;
  system.Solve(x);
  EXPECT_NEAR(x[0], 1.0, 1e-14);
  EXPECT_NEAR(x[6], 2.0, 1e-14);
  EXPECT_EQ(x.segment<5>(1), (Eigen::Matrix<double, 5, 1>::Zero()));
}

// Joints 0, 1 and 3 are one finger, 2 and 4 another, 5 is alone.
TEST(ArrowSystem, SolvesWhatADenseSolverSolves) {
  Random random(7);
  const std::vector<std::vector<int>> groups{{0, 1, 3}, {2, 4}, {5}};
  ArrowSystem system(6, {{1, 3}, {0, 1}, {2, 4}});
  for (int trial = 0; trial < 50; ++trial) {
    // A sum of squares of the two sides of each contact.
    Eigen::MatrixXd A = 0.1 * Eigen::MatrixXd::Identity(12, 12);
    for (const std::vector<int>& group : groups) {
      for (int contact = 0; contact < 4; ++contact) {
        Eigen::VectorXd row = Eigen::VectorXd::Zero(12);
        for (int i = 0; i < 6; ++i) row[i] = random.NextUniform(-1.0, 1.0);
        for (const int k : group) row[6 + k] = random.NextUniform(-1.0, 1.0);
        A += row * row.transpose();
      }
    }
    Eigen::VectorXd b(12);
    for (double& value : b) value = random.NextUniform(-1.0, 1.0);
    system.SetZero();
    system.body() = A.topLeftCorner<6, 6>();
    system.body_right() = b.head<6>();
    for (int k = 0; k < 6; ++k) {
      system.coupling(k) = A.col(6 + k).head<6>();
      for (int l = 0; l <= k; ++l) system.joint(k, l) = A(6 + k, 6 + l);
      system.right(k) = b[6 + k];
    }
    Eigen::VectorXd x;
    system.Solve(x);
    EXPECT_LT((x - A.fullPivLu().solve(b)).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace graspdb
