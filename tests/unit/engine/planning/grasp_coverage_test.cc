#include "engine/planning/grasp_coverage.h"

#include <gtest/gtest.h>

#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// A box's eight corners are as far apart as its vertices can be: its regions.
class BoxCoverage : public testing::Test {
 protected:
  static Grasp MakeGrasp(const Eigen::Vector3d& approach_O,
                         const std::vector<Eigen::Vector3d>& points) {
    Grasp grasp;
    grasp.approach_O = approach_O;
    for (const Eigen::Vector3d& p : points) {
      grasp.contacts.push_back({1, p, Eigen::Vector3d::UnitX(), 0.0});
    }
    return grasp;
  }

  const TriangleMesh box_ = workshop::MakeBox({0.04, 0.06, 0.08});
};

TEST_F(BoxCoverage, OfNothingIsNothing) {
  const GraspCoverage coverage = CalcGraspCoverage({}, box_);
  EXPECT_EQ(coverage.approaches, 0.0);
  EXPECT_EQ(coverage.pairs, 0.0);
}

TEST_F(BoxCoverage, CountsADirectionAndARegionOnce) {
  const Eigen::Vector3d one(0.02, 0.03, 0.03), same(0.01, 0.03, 0.035),
      other(-0.02, 0.03, 0.03);
  const std::vector<Grasp> grasps{
      MakeGrasp(Eigen::Vector3d::UnitX(), {one, same}),
      MakeGrasp(Eigen::Vector3d(1.0, 0.1, 0.0).normalized(), {one})};
  EXPECT_DOUBLE_EQ(CalcGraspCoverage(grasps, box_).approaches, 1.0 / 26.0);
  EXPECT_DOUBLE_EQ(CalcGraspCoverage(grasps, box_).pairs, 1.0 / (26.0 * 8.0));
  const std::vector<Grasp> more{grasps[0],
                                MakeGrasp(Eigen::Vector3d::UnitX(), {other}),
                                MakeGrasp(-Eigen::Vector3d::UnitX(), {other})};
  EXPECT_DOUBLE_EQ(CalcGraspCoverage(more, box_).approaches, 2.0 / 26.0);
  EXPECT_DOUBLE_EQ(CalcGraspCoverage(more, box_).pairs, 3.0 / (26.0 * 8.0));
}

TEST_F(BoxCoverage, IsWholeWhenEveryCornerIsTouchedFromEverywhere) {
  std::vector<Grasp> grasps;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const Eigen::Vector3d direction(x, y, z);
        if (direction.norm() == 0.0) continue;
        grasps.push_back(MakeGrasp(direction.normalized(), box_.vertices()));
      }
    }
  }
  EXPECT_EQ(CalcGraspCoverage(grasps, box_).approaches, 1.0);
  EXPECT_EQ(CalcGraspCoverage(grasps, box_).pairs, 1.0);
}

}  // namespace
}  // namespace graspdb
