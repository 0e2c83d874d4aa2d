#include "engine/pipeline/source_grasps.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace graspdb {
namespace {

TEST(SourceGrasps, TenComeFromEachQuartile) {
  const std::vector<int> drawn = DrawByQuartile(200, 40, 3);
  ASSERT_EQ(drawn.size(), 40u);
  EXPECT_EQ(std::set<int>(drawn.begin(), drawn.end()).size(), 40u);
  for (int quartile = 0; quartile < 4; ++quartile) {
    int count = 0;
    for (const int i : drawn) count += i / 50 == quartile;
    EXPECT_EQ(count, 10);
  }
}

TEST(SourceGrasps, TheSeedDecides) {
  EXPECT_EQ(DrawByQuartile(200, 40, 3), DrawByQuartile(200, 40, 3));
  EXPECT_NE(DrawByQuartile(200, 40, 3), DrawByQuartile(200, 40, 4));
}

TEST(SourceGrasps, AllAreTakenWhenThereAreFew) {
  EXPECT_EQ(DrawByQuartile(7, 40, 1).size(), 7u);
}

TEST(SourceGrasps, ThoseTooNearWhatIsKeptFreeAreLeftOut) {
  GraspSpace space;
  space.grasps.resize(4);
  space.clearances = {{0.0, 0.02}, {0.0, 0.005}, {0.0, 0.01}, {0.0, 0.0}};
  EXPECT_THAT(DrawSourceGrasps(space, {1}, 0.01, 40, 1),
              testing::ElementsAre(0, 2));
  EXPECT_THAT(DrawSourceGrasps(space, {}, 0.01, 40, 1),
              testing::ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(DrawSourceGrasps(space, {0}, 0.01, 40, 1), testing::IsEmpty());
}

}  // namespace
}  // namespace graspdb
