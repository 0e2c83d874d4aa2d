#include "server/bench/html_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/bench/bench_rows.h"
#include "server/bench/svg_plot.h"

namespace graspdb {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Json MakeReport() {
  Json row =
      MakeFailedRow("body", 40, {ErrorCode::kUnusableInput, "<holes>", ""});
  row["group"] = "paper";
  row["number"] = 1;
  row["category"] = "mug";
  row["object"] = "latte & co";
  Json variant;
  variant["name"] = "default";
  variant["learning"] = Json::array();
  variant["rows"] = {row};
  variant["pooled"]["paper"] = PoolRows({row});
  Json report;
  report["engine_version"] = "1";
  report["simulator"] = "none";
  report["seed"] = 1;
  report["sources_per_part"] = 40;
  report["quick"] = false;
  report["machine"]["cores"] = 2;
  report["tests"] = Json::object();
  report["variants"] = {variant};
  report["ablations"] = Json::array();
  return report;
}

TEST(HtmlReport, StandsAloneAndEscapesWhatItIsTold) {
  const std::string html = MakeHtmlReport(MakeReport());
  EXPECT_THAT(html, HasSubstr("#1 mug latte &amp; co body"));
  EXPECT_THAT(html, HasSubstr("&lt;holes&gt;"));
  EXPECT_THAT(html, Not(HasSubstr("src=")));
  EXPECT_THAT(html, Not(HasSubstr("href=")));
}

// Table II, row 1: 752 triangles, 37 / 35 and 35 / 29 of 40.
TEST(HtmlReport, PutsThePapersRowBesideOurs) {
  const std::string html = MakeHtmlReport(MakeReport());
  EXPECT_THAT(html, HasSubstr(">752<"));
  EXPECT_THAT(html, HasSubstr(">37 / 35<"));
  EXPECT_THAT(html, HasSubstr(">35 / 29<"));
}

// Table III: 1000 points, 38 / 34 and 37 / 31.
TEST(HtmlReport, PutsThePapersCloudBesideTheWholeOneOnly) {
  Json report = MakeReport();
  Json& row = report["variants"][0]["rows"][0];
  row["group"] = "cloud";
  row["number"] = 0;
  row["object"] = "latte, all around";
  std::string html = MakeHtmlReport(report);
  EXPECT_THAT(html, HasSubstr(">1000<"));
  EXPECT_THAT(html, HasSubstr(">38 / 34<"));
  EXPECT_THAT(html, Not(HasSubstr(">752<")));
  row["object"] = "latte, one side";
  EXPECT_THAT(MakeHtmlReport(report), Not(HasSubstr(">1000<")));
}

TEST(HtmlReport, AsTextNamesEveryGroup) {
  EXPECT_THAT(MakeTextReport(MakeReport()),
              ::testing::AllOf(HasSubstr("default"), HasSubstr("paper"),
                               HasSubstr("0.0 %")));
}

// x from 0 to 2 fills 260 pixels right of 44, y from 0 to 4 186 above 206.
TEST(SvgPlot, PutsPointsWhereTheAxesSay) {
  PlotSeries series{"", "red", {1.0, 2.0}, {4.0, 0.0}};
  const std::string svg = MakeSvgPlot({series}, PlotOptions());
  EXPECT_THAT(svg, HasSubstr("cx=\"174.0\" cy=\"20.0\""));
  EXPECT_THAT(svg, HasSubstr("cx=\"304.0\" cy=\"206.0\""));
}

// Three decades share 260 and 186 pixels.
TEST(SvgPlot, LogarithmicAxesGiveEachPowerOfTenAsMuchRoom) {
  PlotSeries series{"", "red", {1.0, 100.0, 1000.0}, {0.01, 0.1, 10.0}};
  PlotOptions options;
  options.logarithmic = true;
  const std::string svg = MakeSvgPlot({series}, options);
  EXPECT_THAT(svg, HasSubstr("cx=\"44.0\" cy=\"206.0\""));
  EXPECT_THAT(svg, HasSubstr("cx=\"217.3\" cy=\"144.0\""));
  EXPECT_THAT(svg, HasSubstr("cx=\"304.0\" cy=\"20.0\""));
}

TEST(SvgPlot, AloneBringsItsStyleAlong) {
  PlotOptions options;
  options.alone = true;
  EXPECT_THAT(MakeSvgPlot({}, options),
              ::testing::AllOf(HasSubstr("xmlns="), HasSubstr("<style>")));
  EXPECT_THAT(MakeSvgPlot({}, PlotOptions()), Not(HasSubstr("<style>")));
}

TEST(SvgPlot, WithADiagonalBothAxesReachAsFar) {
  PlotSeries series{"", "red", {1.0}, {4.0}};
  PlotOptions options;
  options.diagonal = true;
  EXPECT_THAT(MakeSvgPlot({series}, options),
              HasSubstr("cx=\"109.0\" cy=\"20.0\""));
}

}  // namespace
}  // namespace graspdb
