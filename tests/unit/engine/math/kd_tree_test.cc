#include "engine/math/kd_tree.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "engine/base/contract.h"
#include "engine/base/random.h"

namespace graspdb {
namespace {

Eigen::MatrixXd MakePoints(int dimension, int count, uint64_t seed) {
  Random random(seed);
  return Eigen::MatrixXd::NullaryExpr(
      dimension, count, [&](Eigen::Index) { return random.NextUniform(); });
}

// The oracle: every distance, sorted.
std::vector<KdTree::Neighbour> SortAll(const Eigen::MatrixXd& points,
                                       const Eigen::VectorXd& query) {
  std::vector<KdTree::Neighbour> all;
  for (int i = 0; i < points.cols(); ++i) {
    all.push_back({i, (points.col(i) - query).squaredNorm()});
  }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return a.squared_distance < b.squared_distance;
  });
  return all;
}

class KdTreeOfDimension : public testing::TestWithParam<int> {};

TEST_P(KdTreeOfDimension, FindsWhatTryingAllPointsFinds) {
  const Eigen::MatrixXd points = MakePoints(GetParam(), 500, 1);
  const KdTree tree(points);
  const Eigen::MatrixXd queries = MakePoints(GetParam(), 100, 2);
  for (int q = 0; q < queries.cols(); ++q) {
    const auto all = SortAll(points, queries.col(q));
    EXPECT_EQ(tree.FindNearest(queries.col(q)).index, all[0].index);
    const auto nearest = tree.FindNearest(queries.col(q), 7);
    ASSERT_EQ(nearest.size(), 7u);
    for (int i = 0; i < 7; ++i) {
      EXPECT_EQ(nearest[i].index, all[i].index);
      EXPECT_NEAR(nearest[i].squared_distance, all[i].squared_distance, 1e-12);
    }
    const auto within = tree.FindWithin(queries.col(q), 0.3);
    const auto expected =
        std::count_if(all.begin(), all.end(), [](const auto& neighbour) {
          return neighbour.squared_distance < 0.3 * 0.3;
        });
    ASSERT_EQ(static_cast<long>(within.size()), expected);
    for (size_t i = 0; i < within.size(); ++i) {
      EXPECT_EQ(within[i].index, all[i].index);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(ThreeSixAndAnother, KdTreeOfDimension,
                         testing::Values(3, 6, 4));

TEST(KdTree, GivesAllPointsWhenMoreAreWanted) {
  const KdTree tree(std::vector<Eigen::Vector3d>{{0, 0, 0}, {1, 0, 0}});
  EXPECT_EQ(tree.FindNearest(Eigen::Vector3d(0.9, 0, 0), 5).size(), 2u);
}

TEST(KdTree, StillWorksAfterAMove) {
  KdTree tree(std::vector<Eigen::Vector3d>{{0, 0, 0}, {1, 0, 0}});
  const KdTree moved = std::move(tree);
  EXPECT_EQ(moved.FindNearest(Eigen::Vector3d(0.9, 0, 0)).index, 1);
}

TEST(KdTree, RefusesNoPointsAndAForeignDimension) {
  EXPECT_THROW(KdTree(std::vector<Eigen::Vector3d>{}), ContractViolation);
  const KdTree tree(std::vector<Eigen::Vector3d>{{0, 0, 0}});
  EXPECT_THROW(tree.FindNearest(Eigen::Vector2d(0, 0)), ContractViolation);
}

}  // namespace
}  // namespace graspdb
