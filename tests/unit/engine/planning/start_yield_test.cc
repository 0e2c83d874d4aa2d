#include "engine/planning/start_yield.h"

#include <gtest/gtest.h>

namespace graspdb {
namespace {

TEST(StartYield, IsWhatIsExpectedUntilSomethingIsKnown) {
  EXPECT_DOUBLE_EQ(CalcYield({}, 0.01), 0.01);
  EXPECT_DOUBLE_EQ(CalcYield({.tries = 100, .gains = 0}, 0.01), 0.005);
  EXPECT_DOUBLE_EQ(CalcYield({.tries = 1900, .gains = 99}, 0.01), 0.05);
}

TEST(StartYield, GrowsWithGainsAndFallsWithTries) {
  for (const int tries : {1, 10, 1000}) {
    EXPECT_LT(CalcYield({tries, 0}, 0.01), CalcYield({tries, 1}, 0.01));
    EXPECT_LT(CalcYield({tries + 1, 1}, 0.01), CalcYield({tries, 1}, 0.01));
  }
}

// How many of 10,000 draws each gets, the last one being elsewhere.
std::vector<int> CountDraws(const std::vector<double>& yields) {
  Random random(1);
  std::vector<int> counts(yields.size() + 1);
  for (int i = 0; i < 10'000; ++i) {
    ++counts[DrawByYield(yields, 0.005, random).value_or(yields.size())];
  }
  return counts;
}

TEST(StartYield, DrawsInProportionToTheYields) {
  // .04 + .005 + .005 elsewhere.
  const std::vector<int> counts = CountDraws({0.04, 0.005});
  EXPECT_NEAR(counts[0], 8000, 200);
  EXPECT_NEAR(counts[1], 1000, 150);
  EXPECT_NEAR(counts[2], 1000, 150);
}

TEST(StartYield, DrawsElsewhereWhereNothingComesOfAny) {
  EXPECT_EQ(CountDraws({})[0], 10'000);
  const double barren = CalcYield({.tries = 14'000, .gains = 0}, 0.01);
  EXPECT_GT(CountDraws({barren, barren})[2], 9'500);
}

}  // namespace
}  // namespace graspdb
