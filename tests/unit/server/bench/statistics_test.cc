#include "server/bench/statistics.h"

#include <gtest/gtest.h>

namespace graspdb {
namespace {

// Wilson 1927; the figures are those of Newcombe 1998, table I: 81 of 263, 15
// of 148, 0 of 20, 1 of 29.
TEST(Proportion, HasWilsonsInterval) {
  const struct {
    int hits, count;
    double lower, upper;
  } cases[] = {{81, 263, 0.2553, 0.3662},
               {15, 148, 0.0624, 0.1605},
               {0, 20, 0.0, 0.1611},
               {1, 29, 0.0061, 0.1718}};
  for (const auto& c : cases) {
    const Proportion proportion = CalcProportion(c.hits, c.count);
    EXPECT_NEAR(proportion.lower, c.lower, 5e-5) << c.hits;
    EXPECT_NEAR(proportion.upper, c.upper, 5e-5) << c.hits;
  }
}

TEST(Proportion, OfNothingTellsNothing) {
  const Proportion none = CalcProportion(0, 0);
  EXPECT_EQ(none.share(), 0.0);
  EXPECT_EQ(none.lower, 0.0);
  EXPECT_EQ(none.upper, 1.0);
}

TEST(Quantile, LiesBetweenTheRanks) {
  EXPECT_EQ(CalcQuantile({3.0, 1.0, 2.0}, 0.5), 2.0);
  EXPECT_EQ(CalcQuantile({4.0, 1.0}, 0.5), 2.5);
  EXPECT_EQ(CalcQuantile({4.0, 1.0}, 0.0), 1.0);
  EXPECT_EQ(CalcQuantile({4.0, 1.0}, 1.0), 4.0);
  EXPECT_NEAR(CalcQuantile({0.0, 10.0}, 0.1), 1.0, 1e-12);
  EXPECT_EQ(CalcQuantile({}, 0.5), 0.0);
}

}  // namespace
}  // namespace graspdb
