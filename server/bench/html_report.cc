#include "server/bench/html_report.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "server/bench/published_results.h"
#include "server/bench/svg_plot.h"
#include "server/codec/markup.h"

namespace graspdb {
namespace {

constexpr char kOurs[] = "#1f77b4";
constexpr char kTheirs[] = "#d62728";
constexpr char kOther[] = "#888";
constexpr char kThird[] = "#2ca02c";

constexpr char kHead[] = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>graspdb: the paper's evaluation</title>
<style>
body { font-family: sans-serif; margin: 2em auto; max-width: 90em;
       padding: 0 1em; color: #222; }
table { border-collapse: collapse; margin: 1em 0; font-size: 14px; }
th, td { border-bottom: 1px solid #ddd; padding: 3px 6px; text-align: right; }
td { white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
th { background: #f4f4f4; vertical-align: bottom; }
.scroll { overflow-x: auto; }
.p { color: #777; }
.low { color: #b00; }
.grid { display: flex; flex-wrap: wrap; gap: 12px; }
)";

using Cells = std::vector<std::string>;

std::string MakeRow(const char* tag, const Cells& cells) {
  std::string row = "<tr>";
  for (const std::string& cell : cells) {
    row += fmt::format("<{0}>{1}</{0}>", tag, cell);
  }
  return row + "</tr>\n";
}

std::string MakeTable(const Cells& head, const std::vector<Cells>& rows) {
  std::string table = "<div class=\"scroll\"><table>\n" + MakeRow("th", head);
  for (const Cells& row : rows) table += MakeRow("td", row);
  return table + "</table></div>\n";
}

std::string Muted(const std::string& text) {
  return "<span class=\"p\">" + text + "</span>";
}

std::string Percent(double share) {
  return fmt::format("{:.1f} %", 100 * share);
}

// "95.2 % (93.0-96.8)"
std::string Interval(const Json& proportion) {
  if (!proportion.is_object() || proportion.value("count", 0) == 0) return "-";
  return fmt::format("{} <span class=\"p\">({:.1f}-{:.1f})</span>",
                     Percent(proportion["share"].get<double>()),
                     100 * proportion["lower"].get<double>(),
                     100 * proportion["upper"].get<double>());
}

std::string Hits(const Json& proportion) {
  if (!proportion.is_object() || proportion.value("count", 0) == 0) return "-";
  return fmt::format("{}/{}", proportion["hits"].get<int>(),
                     proportion["count"].get<int>());
}

std::string NameOf(const Json& row) {
  const int number = row["number"].get<int>();
  return EscapeMarkup(fmt::format(
      "{}{} {} {}", number > 0 ? fmt::format("#{} ", number) : std::string(),
      row["category"].get<std::string>(), row["object"].get<std::string>(),
      row["part"].get<std::string>()));
}

const PublishedTransfer* FindPublished(const Json& row) {
  const bool cloud = row["group"] == "cloud";
  if (!cloud && row["group"] != "paper") return nullptr;
  if (cloud && !row["object"].get<std::string>().ends_with("all around")) {
    return nullptr;
  }
  for (const PublishedTransfer& published : GetPublishedTransfers()) {
    if (row["category"] == published.category &&
        row["part"] == published.part &&
        published.object == (cloud ? 0 : row["number"].get<int>())) {
      return &published;
    }
  }
  return nullptr;
}

std::string MakeSummary(const Json& variant) {
  std::vector<Cells> rows;
  for (const auto& [group, pool] : variant["pooled"].items()) {
    const Json& physical = pool["physical"];
    rows.push_back(
        {EscapeMarkup(group), pool["rows"].dump(),
         Interval(pool["transferred"]), Interval(pool["assembled"]),
         fmt::format("{} / {}", pool["least_row"]["transferred"].dump(),
                     pool["least_row"]["assembled"].dump()),
         Interval(pool["open_close"]["transferred"]),
         Interval(pool["open_close"]["assembled"]),
         Interval(pool["over_open_close"]["assembled"]),
         Interval(pool["over_example"]["assembled"]),
         fmt::format("{:.2f} / {:.2f}", pool["robust"]["median"].get<double>(),
                     pool["robust"]["tenth_percentile"].get<double>()),
         Interval(physical["six_pushes"]),
         Interval(physical["six_pushes_top_ten"]),
         physical.contains("net_displacement")
             ? Interval(physical["net_displacement"])
             : "-",
         physical.contains("lift") ? Interval(physical["lift"]) : "-",
         fmt::format("{:.3f}", 1e3 * pool["penetration_m"].get<double>())});
  }
  return MakeTable(
      {"rows", "count", "transferred", "assembled", "least row",
       "open-close transferred", "open-close assembled",
       "better than open-close", "better than the example",
       "robust median / 10th", "six pushes", "six pushes, top ten",
       "net displacement, friction 3", "lift of 0.5 kg", "penetration, mm"},
      rows);
}

std::string MakeLearningTable(const Json& variant) {
  std::vector<Cells> rows;
  for (const Json& row : variant["learning"]) {
    const PublishedLearning* published = nullptr;
    for (const PublishedLearning& one : GetPublishedLearning()) {
      if (row["category"] == one.category && row["part"] == one.part) {
        published = &one;
      }
    }
    const Json& last = row["curve"].empty() ? Json() : row["curve"].back();
    const auto theirs = [&](const std::string& text) {
      return published != nullptr ? Muted(text) : Muted("-");
    };
    const PublishedLearning none{};
    const PublishedLearning& p = published != nullptr ? *published : none;
    rows.push_back(
        {EscapeMarkup(row["category"].get<std::string>() + " " +
                      row["part"].get<std::string>()),
         row["triangles"].dump(), theirs(std::to_string(p.triangles)),
         fmt::format("{:.1f}",
                     row["configuration_space_seconds"].get<double>()),
         theirs(fmt::format("{:.0f}", p.configuration_space_seconds)),
         fmt::format("{:.1f}", row["search_seconds"].get<double>()),
         theirs(fmt::format("{:.0f}", p.search_seconds)), row["grasps"].dump(),
         theirs(std::to_string(p.grasps)),
         fmt::format("{:.3f}", row["median_epsilon"].get<double>()),
         Percent(row["coverage"].get<double>()),
         Percent(row["pair_coverage"].get<double>()),
         last.is_null() ? "-"
                        : Percent(last["balanced_accuracy"].get<double>()),
         last.is_null() ? "-"
                        : Percent(last["boundary_accuracy"].get<double>())});
  }
  return MakeTable(
      {"part", "triangles", Muted("paper"), "configuration space, s",
       Muted("paper"), "search, s", Muted("paper"), "distinct stable grasps",
       Muted("paper"), "median eps", "approach directions",
       "of direction and region", "balanced accuracy", "near the boundary"},
      rows);
}

std::string MakeTransferTable(const Json& variant, const std::string& group) {
  std::vector<Cells> rows;
  for (const Json& row : variant["rows"]) {
    if (row["group"] != group) continue;
    const PublishedTransfer* p = FindPublished(row);
    const int attempted = std::max(1, row["attempted"].get<int>());
    const auto both = [](int ours, int theirs) {
      return fmt::format("{} / {}", ours, theirs);
    };
    std::string failures;
    for (const auto& [reason, count] : row["failures"].items()) {
      failures += (failures.empty() ? "" : ", ") + reason + " " + count.dump();
    }
    const Json& physical = row["physical"];
    rows.push_back(
        {NameOf(row), row["triangles"].dump(),
         Muted(p != nullptr ? std::to_string(p->size) : "-"),
         fmt::format(
             "{:.0f} + {:.0f}",
             1e3 * row["seconds"]["transfer"].get<double>() / attempted,
             1e3 * row["seconds"]["assembly"].get<double>() / attempted),
         Muted(p != nullptr && p->transfer_seconds > 0.0
                   ? fmt::format("{:.0f} + {:.0f} s", p->transfer_seconds,
                                 p->assembly_seconds)
                   : "-"),
         both(row["transferred"].get<int>(),
              row["open_close"]["transferred"].get<int>()),
         Muted(p != nullptr ? both(p->transferred, p->transferred_open_close)
                            : "-"),
         both(row["assembled"].get<int>(),
              row["open_close"]["assembled"].get<int>()),
         Muted(p != nullptr ? both(p->assembled, p->assembled_open_close)
                            : "-"),
         Hits(row["over_open_close"]["assembled"]),
         Hits(row["over_example"]["assembled"]),
         fmt::format("{:.3f}", row["median_epsilon"].get<double>()),
         fmt::format("{:.2f}", row["robust"]["median"].get<double>()),
         Hits(physical["six_pushes"]), Hits(physical["six_pushes_top_ten"]),
         Hits(physical.value("net_displacement", Json())),
         Hits(physical.value("lift", Json())),
         EscapeMarkup(row.contains("error") ? row["error"].get<std::string>()
                                            : failures)});
  }
  if (rows.empty()) return "";
  return MakeTable(
      {"novel object", "triangles", Muted("paper"), "ms per grasp, both stages",
       Muted("paper"), "transferred, ours / open-close", Muted("paper"),
       "assembled, ours / open-close", Muted("paper"), "better than open-close",
       "better than the example", "median eps", "robust", "six pushes",
       "top ten", "net displacement", "lift", "failures"},
      rows);
}

// Both of the numbers, where both are known.
void AddPoint(const Json& x, const Json& y, PlotSeries& series) {
  if (!x.is_number() || !y.is_number()) return;
  series.x.push_back(x.get<double>());
  series.y.push_back(y.get<double>());
}

// Quality of novel against example, by grasp index, best example first.
std::string PlotQuality(const Json& row, const std::string& stage,
                        const std::string& example, const std::string& novel) {
  std::vector<Json> points = row["points"].get<std::vector<Json>>();
  std::stable_sort(points.begin(), points.end(),
                   [&](const Json& a, const Json& b) {
                     return a[example].get<double>() > b[example].get<double>();
                   });
  PlotSeries theirs{"example", kOther, {}, {}, true};
  PlotSeries ours{"novel", kOurs, {}, {}};
  for (size_t i = 0; i < points.size(); ++i) {
    AddPoint(i + 1, points[i][example], theirs);
    AddPoint(i + 1, points[i][novel], ours);
  }
  PlotOptions options;
  options.title = stage;
  options.x_label = "grasp";
  options.y_label = "eps";
  return MakeSvgPlot({theirs, ours}, options);
}

// Ours over open-close, with the share above the diagonal.
std::string PlotComparison(const Json& row, const std::string& stage,
                           const std::string& baseline,
                           const std::string& novel, const Json& over) {
  PlotSeries ours{"", kOurs, {}, {}};
  for (const Json& point : row["points"]) {
    AddPoint(point[baseline], point[novel], ours);
  }
  PlotOptions options;
  options.title = fmt::format("{}: {} above", stage, Hits(over));
  options.x_label = "eps of open-close";
  options.y_label = "eps of ours";
  options.diagonal = true;
  return MakeSvgPlot({ours}, options);
}

std::string MakeFigures(const Json& variant) {
  std::string html;
  for (const Json& row : variant["rows"]) {
    if (row["points"].empty() || row["group"] == "objects") continue;
    html += "<h4>" + NameOf(row) + "</h4>\n<div class=\"grid\">";
    html += PlotQuality(row, "Part", "example", "transferred");
    html +=
        PlotQuality(row, "Whole, after assembly", "example_whole", "assembled");
    html += PlotComparison(row, "Part", "open_close_part", "transferred",
                           row["over_open_close"]["transferred"]);
    html += PlotComparison(row, "Whole", "open_close_whole", "assembled",
                           row["over_open_close"]["assembled"]);
    html += "</div>\n";
  }
  return html;
}

std::string MakeLearningFigures(const Json& variant) {
  std::string html = "<div class=\"grid\">";
  for (const Json& row : variant["learning"]) {
    PlotSeries uniform{"uniform samples", kOther, {}, {}, true};
    PlotSeries boundary{"near the boundary", kTheirs, {}, {}, true};
    for (const Json& round : row["curve"]) {
      AddPoint(round["samples"], round["balanced_accuracy"], uniform);
      AddPoint(round["samples"], round["boundary_accuracy"], boundary);
    }
    PlotOptions options;
    options.title = row["category"].get<std::string>() + " " +
                    row["part"].get<std::string>();
    options.x_label = "labels";
    options.y_label = "balanced accuracy";
    options.y_min = 0.5;
    options.y_max = 1.0;
    html += MakeSvgPlot({uniform, boundary}, options);
  }
  return html + "</div>\n";
}

// Distinct grasps over time, by where the swarm started.
std::string MakeSeedingFigures(const Json& variant) {
  if (!variant.contains("seeding")) return "";
  constexpr const char* kColors[] = {kTheirs, kOurs, kThird, kOther};
  std::vector<std::pair<std::string, std::vector<PlotSeries>>> plots;
  for (const Json& row : variant["seeding"]) {
    const std::string part = row["category"].get<std::string>() + " " +
                             row["part"].get<std::string>();
    if (plots.empty() || plots.back().first != part) {
      plots.emplace_back(part, std::vector<PlotSeries>());
    }
    std::vector<PlotSeries>& series = plots.back().second;
    PlotSeries one;
    one.name = row["seeding"].get<std::string>();
    one.color = kColors[series.size() % std::size(kColors)];
    one.line = true;
    for (const Json& point : row["curve"]) {
      AddPoint(point["seconds"], point["grasps"], one);
    }
    series.push_back(std::move(one));
  }
  std::string html =
      "<h3>Where the swarm starts: distinct grasps at equal time</h3>\n"
      "<div class=\"grid\">";
  for (const auto& [part, series] : plots) {
    PlotOptions options;
    options.title = part;
    options.x_label = "seconds, all cores";
    options.y_label = "grasps";
    html += MakeSvgPlot(series, options);
  }
  return html + "</div>\n";
}

std::string MakeFailureTable(const Json& variants) {
  std::vector<Cells> rows;
  for (const Json& variant : variants) {
    for (const auto& [group, pool] : variant["pooled"].items()) {
      for (const auto& [reason, count] : pool["failures"].items()) {
        rows.push_back({EscapeMarkup(variant["name"].get<std::string>()), group,
                        EscapeMarkup(reason), count.dump()});
      }
    }
  }
  return MakeTable({"parameters", "rows", "reason", "grasps"}, rows);
}

std::string MakeAblationTable(const Json& report) {
  std::vector<Cells> rows;
  const auto add = [&rows](const Json& variant) {
    if (!variant["pooled"].contains("paper")) return;
    const Json& pool = variant["pooled"]["paper"];
    int grasps = 0;
    for (const Json& row : variant["learning"])
      grasps += row["grasps"].get<int>();
    rows.push_back(
        {EscapeMarkup(variant["name"].get<std::string>()),
         std::to_string(grasps), Interval(pool["transferred"]),
         Interval(pool["assembled"]),
         Interval(pool["over_open_close"]["assembled"]),
         fmt::format("{:.2f} / {:.2f}", pool["robust"]["median"].get<double>(),
                     pool["robust"]["tenth_percentile"].get<double>()),
         Interval(pool["physical"]["six_pushes"])});
  };
  for (const Json& variant : report["variants"]) add(variant);
  for (const Json& variant : report["ablations"]) add(variant);
  return MakeTable(
      {"parameters", "learned grasps", "transferred", "assembled",
       "better than open-close", "robust median / 10th", "six pushes"},
      rows);
}

}  // namespace

std::string MakeHtmlReport(const Json& report) {
  std::string html =
      std::string(kHead) + kPlotStyle + "</style>\n</head>\n<body>\n";
  html += "<h1>The paper's evaluation</h1>\n";
  html += fmt::format(
      "<p>graspdb {}, {}; seed {}, {} source grasps per part{}; {} cores. "
      "Friction 0.5, stable from eps 0.001. Behind a share stands its 95 % "
      "interval [Wilson]; grey is what the paper printed, with its own objects "
      "and segmentation.</p>\n",
      EscapeMarkup(report["engine_version"].get<std::string>()),
      EscapeMarkup(report["simulator"].get<std::string>()),
      report["seed"].dump(), report["sources_per_part"].dump(),
      report["quick"].get<bool>() ? ", quick run" : "",
      report["machine"]["cores"].dump());
  html += "<p>Simulated, of all assembled grasps: ";
  for (const auto& [key, name] : report["tests"].items()) {
    html += "<b>" + EscapeMarkup(key) +
            "</b>: " + EscapeMarkup(name.get<std::string>()) + ". ";
  }
  html += "</p>\n";
  for (const Json& variant : report["variants"]) {
    html +=
        "<h2>Parameters: " + EscapeMarkup(variant["name"].get<std::string>()) +
        "</h2>\n";
    html += MakeSummary(variant);
    html += "<h3>Table I: learning</h3>\n" + MakeLearningTable(variant);
    html += "<h3>Table II: transfer and assembly</h3>\n" +
            MakeTransferTable(variant, "paper") +
            MakeTransferTable(variant, "further");
    const std::string clouds = MakeTransferTable(variant, "cloud");
    if (!clouds.empty()) {
      html += "<h3>Table III: reconstructed from points</h3>\n" + clouds;
    }
    const std::string objects = MakeTransferTable(variant, "objects");
    if (!objects.empty()) {
      html += "<h3>Other people's meshes</h3>\n" + objects;
    }
  }
  html += "<h2>Why grasps failed</h2>\n" + MakeFailureTable(report["variants"]);
  if (!report["ablations"].empty()) {
    html += "<h2>What each lever is worth</h2>\n" + MakeAblationTable(report);
  }
  for (const Json& variant : report["variants"]) {
    html += "<h2>Figures: " + EscapeMarkup(variant["name"].get<std::string>()) +
            "</h2>\n<h3>Active learning</h3>\n" + MakeLearningFigures(variant) +
            MakeSeedingFigures(variant) + "<h3>Quality of each grasp</h3>\n" +
            MakeFigures(variant);
  }
  return html + "</body>\n</html>\n";
}

std::string MakeTextReport(const Json& report) {
  std::string text;
  const auto percent = [](const Json& proportion) {
    return proportion.is_object() && proportion.value("count", 0) > 0
               ? fmt::format("{:5.1f} %",
                             100 * proportion["share"].get<double>())
               : std::string("      -");
  };
  for (const char* list : {"variants", "ablations"}) {
    for (const Json& variant : report[list]) {
      text += variant["name"].get<std::string>() + "\n";
      for (const auto& [group, pool] : variant["pooled"].items()) {
        text += fmt::format(
            "  {:<8} {:>3} rows  transferred {}  assembled {}  "
            "over open-close {}  robust {:.2f}  six pushes {}\n",
            group, pool["rows"].get<int>(), percent(pool["transferred"]),
            percent(pool["assembled"]),
            percent(pool["over_open_close"]["assembled"]),
            pool["robust"]["median"].get<double>(),
            percent(pool["physical"]["six_pushes"]));
      }
    }
  }
  return text;
}

}  // namespace graspdb
