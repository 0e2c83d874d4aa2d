#include "server/bench/speed/speed_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/bench/speed/speed_bench.h"

namespace graspdb {
namespace {

using ::testing::HasSubstr;

SpeedRow MakeRow() {
  SpeedRow row;
  row.name = "eps";
  row.timing.samples = {2e-6};
  row.library.emplace();
  row.library->call = "qhull";
  row.library->timing.samples = {3e-3};
  row.goal = 2e-5;
  return row;
}

TEST(Stopwatch, TakesAtLeastThreeSamplesOfAsManyCallsAsTheClockNeeds) {
  int calls = 0;
  const Timing timing = TimeCalls([&] { return ++calls; }, {0.0, 25, false});
  EXPECT_EQ(timing.samples.size(), 3U);
  EXPECT_GT(timing.calls, 1);
  EXPECT_GE(calls, 3 * timing.calls);
  for (const double seconds : timing.samples) EXPECT_GT(seconds, 0.0);
}

TEST(Stopwatch, TellsTheMedianAndTheQuartiles) {
  const Json json = EncodeTiming({{4.0, 1.0, 2.0, 3.0, 5.0}, 10});
  EXPECT_EQ(json["median"], 3.0);
  EXPECT_EQ(json["lower"], 2.0);
  EXPECT_EQ(json["upper"], 4.0);
  EXPECT_EQ(json["samples"], 5);
  EXPECT_EQ(json["calls"], 10);
}

TEST(SpeedRow, SaysHowManyTimesAsLongTheLibraryTakes) {
  SpeedRow row = MakeRow();
  row.triangles = 7000;
  const Json json = EncodeSpeedRow(row);
  EXPECT_NEAR(json["library"]["times"].get<double>(), 1500.0, 1e-9);
  EXPECT_EQ(json["triangles"], 7000);
  EXPECT_EQ(json["goal"], 2e-5);
  row.library.reset();
  row.triangles.reset();
  const Json alone = EncodeSpeedRow(row);
  EXPECT_TRUE(alone["library"].is_null());
  EXPECT_TRUE(alone["triangles"].is_null());
}

TEST(SpeedReport, PutsGoalAndLibraryBesideEachFigure) {
  Json report;
  report["engine_version"] = "1";
  report["machine"] = {{"processor", "abacus"},
                       {"cores", 2},
                       {"load", 0.5},
                       {"compiler", "c"},
                       {"flags", "-O3"}};
  report["primitives"] = {EncodeSpeedRow(MakeRow())};
  report["stages"] = Json::array();
  report["requests"] = {{"rows", Json::array()},
                        {"queries", Json::array()},
                        {"start_seconds", 0.02},
                        {"peak_bytes", 32 << 20}};
  report["growth"] = {EncodeGrowthCurve(
      {"start", "stored grasps", "s", {1e3, 1e6}, {0.1, 0.2}})};
  const std::string text = MakeSpeedReport(report);
  EXPECT_THAT(text, HasSubstr("2.00 us"));
  EXPECT_THAT(text, HasSubstr("goal 20.00 us"));
  EXPECT_THAT(text, HasSubstr("qhull: 3.00 ms, x 1500.0"));
  EXPECT_THAT(text, HasSubstr("start 20.00 ms, peak memory 32 MiB"));
  EXPECT_THAT(text, HasSubstr("1000: 0.1  1e+06: 0.2"));
}

}  // namespace
}  // namespace graspdb
