#include "engine/dynamics/touch_finder.h"

#include <gtest/gtest.h>

#include "tests/support/workshop.h"

namespace graspdb {
namespace {

constexpr int kJaw = 1;
constexpr double kNear = 0.0005;

class TouchFinderTest : public testing::Test {
 protected:
  struct Seen {
    int count{0};
    double least{1.0};
    Eigen::Vector3d nhat_O{0, 0, 0};  // Of the nearest.
  };

  // The jaw's inner face, at its frame's origin, `gap` from the box's side.
  Seen See(TouchFinder& finder, double gap, double near = kNear) const {
    RigidTransform X_OL;
    X_OL.translation = {-0.02 - gap, 0.0, -0.03};
    Seen seen;
    finder.Visit(kJaw, X_OL, near,
                 [&](const Eigen::Vector3d&, double distance,
                     const Eigen::Vector3d& nhat_O) {
                   ++seen.count;
                   if (distance >= seen.least) return;
                   seen.least = distance;
                   seen.nhat_O = nhat_O;
                 });
    return seen;
  }

  const HandShape gripper_{workshop::MakeTwoJawGripper()};
  const Solid box_{workshop::MakeBox({0.04, 0.03, 0.05}, 2)};
};

TEST_F(TouchFinderTest, TellsHowFarTheSurfaceIsAndWhichWayIsOut) {
  TouchFinder finder(gripper_, box_, kNear);
  const Seen seen = See(finder, 0.0003);
  EXPECT_GT(seen.count, 10);
  EXPECT_NEAR(seen.least, 0.0003, 0.0001);
  EXPECT_GT(seen.nhat_O.dot(-Eigen::Vector3d::UnitX()), 0.99);
}

TEST_F(TouchFinderTest, SeesOnTheWayWhatAFreshOneSees) {
  TouchFinder finder(gripper_, box_, kNear);
  double before = 0.012;
  int met = 0;
  // There, into the box by 0.5 mm, and back.
  for (int i = 0; i <= 100; ++i) {
    const double gap = 0.012 - 0.00025 * (i <= 50 ? i : 100 - i);
    finder.Move(kJaw, std::abs(gap - before));
    before = gap;
    TouchFinder fresh(gripper_, box_, kNear);
    // Steps that look nearer than others do.
    const double near = i % 3 == 0 ? kNear : 0.2 * kNear;
    const Seen seen = See(finder, gap, near);
    const Seen expected = See(fresh, gap, near);
    ASSERT_EQ(seen.count, expected.count) << gap;
    ASSERT_EQ(seen.least, expected.least) << gap;
    met += seen.count > 0;
  }
  EXPECT_GT(met, 3);
  EXPECT_LT(met, 20);
}

TEST_F(TouchFinderTest, ACopyIsBackWhereItWasMade) {
  TouchFinder finder(gripper_, box_, kNear);
  EXPECT_GT(See(finder, 0.0003).count, 10);
  const TouchFinder before = finder;
  finder.Move(kJaw, 0.02);
  EXPECT_EQ(See(finder, 0.0203).count, 0);
  finder = before;
  EXPECT_GT(See(finder, 0.0003).count, 10);
}

}  // namespace
}  // namespace graspdb
