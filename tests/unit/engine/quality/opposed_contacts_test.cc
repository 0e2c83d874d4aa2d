#include "engine/quality/opposed_contacts.h"

#include <gtest/gtest.h>

namespace graspdb {
namespace {

TEST(OpposedPair, NeedsTwoNormalsMoreThanARightAngleApart) {
  EXPECT_TRUE(HasOpposedPair({{1, 0, 0}, {-1, 0, 0}}, 2));
  EXPECT_FALSE(HasOpposedPair({{1, 0, 0}, {0, 1, 0}}, 2));
  EXPECT_FALSE(HasOpposedPair({{1, 0, 0}}, 2));
}

TEST(OpposedTargets, AreReachedByTheSameLinkNearby) {
  const Contact left{1, {-0.02, 0, 0}, {-1, 0, 0}, 0.0};
  const Contact right{2, {0.02, 0, 0}, {1, 0, 0}, 0.0};
  EXPECT_TRUE(ReachesOpposedTargets({left, right}, {left, right}, 0.01, 2));
  EXPECT_FALSE(ReachesOpposedTargets({left}, {left, right}, 0.01, 2));
  Contact other_link = right;
  other_link.link = 3;
  EXPECT_FALSE(
      ReachesOpposedTargets({left, other_link}, {left, right}, 0.01, 2));
  Contact moved = right;
  moved.p_O.y() = 0.009;
  EXPECT_TRUE(ReachesOpposedTargets({left, moved}, {left, right}, 0.01, 2));
  moved.p_O.y() = 0.011;
  EXPECT_FALSE(ReachesOpposedTargets({left, moved}, {left, right}, 0.01, 2));
}

}  // namespace
}  // namespace graspdb
