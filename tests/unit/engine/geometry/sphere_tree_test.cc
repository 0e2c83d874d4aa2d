#include "engine/geometry/sphere_tree.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "engine/geometry/surface_index.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

class TreeOfABox : public ::testing::Test {
 protected:
  // The distance to a point: Lipschitz with constant one.
  struct DistanceTo {
    double operator()(const Eigen::Vector3d& p) const { return (p - q).norm(); }
    Floats4 operator()(const Points4& p) const {
      Floats4 distances;
      for (int k = 0; k < 4; ++k) {
        distances[k] = static_cast<float>(
            (*this)(Eigen::Vector3d(p.x[k], p.y[k], p.z[k])));
      }
      return distances;
    }
    Eigen::Vector3d q;
  };
  static constexpr double kRounding = 1e-6;

  const TriangleMesh box_ = workshop::MakeBox({0.02, 0.03, 0.05}, 2);
  const SphereTree tree_{box_, 0.002};
};

TEST_F(TreeOfABox, ProbesLieOnTheSurfaceAndCoverIt) {
  const SurfaceIndex index(box_);
  for (const Eigen::Vector3d& p : tree_.probes()) {
    EXPECT_LT(index.FindClosest(p)->distance, 1e-9);
  }
  for (const Eigen::Vector3d& corner : box_.vertices()) {
    double nearest = 1.0;
    for (const Eigen::Vector3d& p : tree_.probes()) {
      nearest = std::min(nearest, (p - corner).norm());
    }
    EXPECT_LT(nearest, 0.002 * 1.8);
  }
}

TEST_F(TreeOfABox, TheBoundIsBelowAndTheEstimateNearTheTruth) {
  const SurfaceIndex index(box_);
  Random random(61);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d q = 0.1 * random.NextInUnitBall();
    const double truth = index.FindClosest(q)->distance;
    EXPECT_LE(tree_.CalcLowerBound(DistanceTo{q}), truth + kRounding);
    const double estimate = tree_.EstimateMinimum(DistanceTo{q});
    EXPECT_LE(estimate, truth + 0.003);
    EXPECT_GE(estimate, 0.5 * truth - kRounding);
  }
}

TEST_F(TreeOfABox, TellsNoMoreOfTheMinimumThanTheRangeAsksFor) {
  Random random(64);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d q = 0.1 * random.NextInUnitBall();
    const auto distance = DistanceTo{q};
    const double full = tree_.EstimateMinimum(distance);
    const double most = random.NextUniform(0.0, 0.1);
    const double capped = tree_.EstimateMinimum(distance, {.most = most});
    EXPECT_LE(capped, most);
    if (full < 0.5 * most) {
      EXPECT_LT(capped, most);
    }
    const double bound = tree_.CalcLowerBound(distance, {.most = most});
    EXPECT_LE(bound, most);
    const double early = tree_.EstimateMinimum(distance, {.enough = most});
    if (full < 0.5 * most) {
      EXPECT_LT(early, most);
    }
  }
}

TEST_F(TreeOfABox, EndsWhereADistanceIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const DistanceTo distance{{nan, nan, nan}};
  EXPECT_GE(tree_.EstimateMinimum(distance), 1e300);
  EXPECT_GE(tree_.CalcLowerBound(distance), 1e300);
  int visited = 0;
  tree_.VisitNear(distance, 0.01,
                  [&](const Eigen::Vector3d&, double) { ++visited; });
  EXPECT_EQ(visited, 0);
}

TEST_F(TreeOfABox, GapBoundOfTwoNeverExceedsTheTruth) {
  Random random(62);
  for (int i = 0; i < 40; ++i) {
    const RigidTransform X_AB{random.NextRotation(),
                              0.12 * random.NextInUnitBall()};
    double truth = 1.0;
    for (const Eigen::Vector3d& p : tree_.probes()) {
      for (const Eigen::Vector3d& q : tree_.probes()) {
        truth = std::min(truth, (p - X_AB * q).squaredNorm());
      }
    }
    truth = std::sqrt(truth);
    const double bound = tree_.CalcGapBound(tree_, X_AB);
    EXPECT_LE(bound, truth);
    EXPECT_GE(bound, 0.5 * truth - 0.02);
    // Whether it is positive does not depend on the range.
    EXPECT_EQ(tree_.CalcGapBound(tree_, X_AB, {0.0, 1e-9}) > 0.0, bound > 0.0);
  }
}

TEST_F(TreeOfABox, VisitsExactlyTheProbesWithinTheLimit) {
  const Eigen::Vector3d q(0.015, 0.0, 0.01);
  const auto distance = DistanceTo{q};
  int visited = 0;
  const double others =
      tree_.VisitNear(distance, 0.012, [&](const Eigen::Vector3d& p, double d) {
        EXPECT_NEAR(d, distance(p), kRounding);
        EXPECT_LE(d, 0.012);
        ++visited;
      });
  const auto expected =
      std::count_if(tree_.probes().begin(), tree_.probes().end(),
                    [&](const auto& p) { return distance(p) <= 0.012; });
  EXPECT_EQ(visited, expected);
  EXPECT_GT(visited, 5);
  // It promises no more than the nearest of the others, nor nothing.
  double nearest = 1.0;
  for (const Eigen::Vector3d& p : tree_.probes()) {
    if (distance(p) > 0.012) nearest = std::min(nearest, distance(p));
  }
  EXPECT_LE(others, nearest);
  EXPECT_GT(others, 0.012);
}

}  // namespace
}  // namespace graspdb
