#include "engine/cspace/svm.h"

#include <gtest/gtest.h>

#include "engine/base/random.h"

namespace graspdb {
namespace {

TEST(Svm, SeparatesADiscFromItsSurroundings) {
  Random random(1);
  constexpr int kCount = 400;
  Eigen::MatrixXd points(2, kCount);
  std::vector<bool> labels(kCount);
  for (int i = 0; i < kCount; ++i) {
    points.col(i) << random.NextUniform(-1, 1), random.NextUniform(-1, 1);
    labels[i] = points.col(i).norm() < 0.6;
  }
  const Svm svm(points, labels, 10.0, 2.0);
  int right = 0;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d p(random.NextUniform(-1, 1),
                            random.NextUniform(-1, 1));
    right += (svm.CalcDecisionValue(p) > 0.0) == (p.norm() < 0.6);
  }
  EXPECT_GT(right, 950);
  EXPECT_GT(svm.support_vectors().size(), 10u);
  EXPECT_LT(svm.support_vectors().size(), 200u);
}

TEST(Svm, TheSignDoesNotDependOnWhichLabelComesFirst) {
  Eigen::MatrixXd points(1, 4);
  points << -2, -1, 1, 2;
  const Svm a(points, {true, true, false, false}, 10.0, 0.5);
  const Svm b(points, {false, false, true, true}, 10.0, 0.5);
  EXPECT_GT(a.CalcDecisionValue(Eigen::VectorXd::Constant(1, -1.5)), 0.0);
  EXPECT_LT(a.CalcDecisionValue(Eigen::VectorXd::Constant(1, 1.5)), 0.0);
  EXPECT_LT(b.CalcDecisionValue(Eigen::VectorXd::Constant(1, -1.5)), 0.0);
  EXPECT_GT(b.CalcDecisionValue(Eigen::VectorXd::Constant(1, 1.5)), 0.0);
}

}  // namespace
}  // namespace graspdb
