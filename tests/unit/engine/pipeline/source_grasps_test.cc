#include "engine/pipeline/source_grasps.h"

#include <set>

#include <gtest/gtest.h>

namespace graspdb {
namespace {

TEST(SourceGrasps, TenComeFromEachQuartile) {
  const std::vector<Grasp> grasps(200);
  const std::vector<int> drawn = DrawSourceGrasps(grasps, 40, 3);
  ASSERT_EQ(drawn.size(), 40u);
  EXPECT_EQ(std::set<int>(drawn.begin(), drawn.end()).size(), 40u);
  for (int quartile = 0; quartile < 4; ++quartile) {
    int count = 0;
    for (const int i : drawn) count += i / 50 == quartile;
    EXPECT_EQ(count, 10);
  }
}

TEST(SourceGrasps, TheSeedDecides) {
  const std::vector<Grasp> grasps(200);
  EXPECT_EQ(DrawSourceGrasps(grasps, 40, 3), DrawSourceGrasps(grasps, 40, 3));
  EXPECT_NE(DrawSourceGrasps(grasps, 40, 3), DrawSourceGrasps(grasps, 40, 4));
}

TEST(SourceGrasps, AllAreTakenWhenThereAreFew) {
  EXPECT_EQ(DrawSourceGrasps(std::vector<Grasp>(7), 40, 1).size(), 7u);
}

}  // namespace
}  // namespace graspdb
