#include "server/bench/speed/speed_bench.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "engine/grasp_engine.h"
#include "server/bench/bench_items.h"
#include "server/bench/speed/server_process.h"
#include "server/bench/speed/speed_growth.h"
#include "server/bench/speed/speed_primitives.h"
#include "server/bench/speed/speed_requests.h"
#include "server/bench/speed/speed_stages.h"
#include "server/bench/svg_plot.h"
#include "server/codec/mesh_writer.h"
#include "server/files.h"
#include "server/jobs/data_folder.h"
#include "server/jobs/sub_context.h"

namespace graspdb {
namespace {

namespace fs = std::filesystem;

constexpr int kMostServed = MeshLimits{}.max_triangles;

std::string FindProcessor() {
  std::ifstream file("/proc/cpuinfo");
  std::string line;
  while (std::getline(file, line)) {
    if (!line.starts_with("model name")) continue;
    const size_t colon = line.find(": ");
    if (colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

Json DescribeMachine() {
  double load = 0.0;
  if (getloadavg(&load, 1) != 1) load = 0.0;
  return {{"processor", FindProcessor()},
          {"cores", std::thread::hardware_concurrency()},
          {"load", load},
          {"compiler", __VERSION__},
          {"flags", GRASPDB_BUILD_FLAGS}};
}

class SpeedBench {
 public:
  SpeedBench(const SpeedBenchOrder& order, const OpenService& open,
             ExecutionContext& context)
      : order_(order),
        open_(open),
        context_(context),
        decoder_(order.decoder),
        db_(fs::path(order.out) / "speed.db") {}

  Result<Json> Run() {
    std::error_code code;
    fs::create_directories(order_.out, code);
    report_["bench"] = "speed";
    report_["engine_version"] = EngineVersion();
    report_["machine"] = DescribeMachine();
    report_["seed"] = order_.seed;
    report_["quick"] = order_.quick;
    GRASPDB_TRY_VOID(Prepare());
    {
      SubContext part(context_, "primitives", 0.3, 0.4);
      part.context().ReportProgress("", 0.0);
      report_["primitives"] =
          EncodeSpeedRows(MeasurePrimitives(hand_, meshes_, stopwatch()));
    }
    GRASPDB_TRY_VOID(RunStages());
    GRASPDB_TRY_VOID(RunRequests());
    GRASPDB_TRY_VOID(RunGrowth());
    GRASPDB_TRY_VOID(WriteFileBytes(fs::path(order_.out) / "speed.json",
                                    report_.dump(1) + "\n"));
    GRASPDB_TRY_VOID(WriteFileBytes(fs::path(order_.out) / "speed.txt",
                                    MakeSpeedReport(report_)));
    return std::move(report_);
  }

 private:
  StopwatchOptions stopwatch() const {
    StopwatchOptions options;
    if (order_.quick) {
      options.seconds = 0.05;
      options.most_samples = 5;
    }
    return options;
  }

  // What was learned, and one novel object in several resolutions.
  Result<void> Prepare() {
    GRASPDB_TRY(learned,
                open_(MakeLearningPath(order_.out, order_.parameters)));
    PopulateOrder populate;
    populate.folder = order_.data;
    populate.categories = {order_.category};
    populate.parameters = order_.parameters;
    populate.seed = order_.seed;
    SubContext learning(context_, "learn", 0.0, 0.3);
    GRASPDB_TRY_VOID(Populate(*learned, populate, learning.context()));
    // What is measured leaves that as it is.
    RemoveDatabase(db_);
    GRASPDB_TRY_VOID(learned->store().WriteBackup(db_));
    GRASPDB_TRY(service, open_(db_));
    GRASPDB_TRY(hand, service->FindHandModel(kDefaultHand));
    hand_ = hand;

    PaperBenchOrder items;
    items.data = order_.data;
    items.categories = {order_.category};
    items.quick = true;
    GRASPDB_TRY(collected, CollectBenchItems(items));
    ImportOrder import = collected.front().mesh;
    import.category = order_.category;
    GRASPDB_TRY(object, service->ImportObject(import, context_));
    GRASPDB_TRY(stored, service->store().ReadObjectMeshes(object.object.id));
    for (const int triangles : Sizes()) {
      GRASPDB_TRY(mesh, ResampleMesh(decoder_, stored.canonical, triangles));
      meshes_.push_back(std::move(mesh));
    }
    return {};
  }

  std::vector<int> Sizes() const {
    if (order_.quick) return {2000, 7000};
    return {2000, 7000, 50'000};
  }

  Result<void> RunStages() {
    GRASPDB_TRY(service, open_(db_));
    StageOrder stages;
    stages.category = order_.category;
    stages.meshes = meshes_;
    if (order_.quick) {
      stages.sources = 2;
      stages.grasps = 10;
      stages.search_seconds = 1;
    }
    stages.seed = order_.seed;
    stages.stopwatch = stopwatch();
    SubContext part(context_, "stages", 0.4, 0.6);
    GRASPDB_TRY(measured,
                MeasureStages(*service, decoder_, stages, part.context()));
    report_["stages"] = EncodeSpeedRows(measured.rows);
    curves_ = std::move(measured.curves);
    return {};
  }

  Result<void> RunRequests() {
    RequestOrder requests;
    requests.db = db_;
    requests.server_options = order_.server_options;
    requests.category = order_.category;
    for (const TriangleMesh& mesh : meshes_) {
      requests.meshes.push_back(WriteMesh(mesh, MeshFormat::kObj));
    }
    requests.repetitions = order_.quick ? 1 : 3;
    if (order_.quick) {
      requests.sources = 2;
    } else {
      GRASPDB_TRY(largest,
                  ResampleMesh(decoder_, meshes_.front(), kMostServed));
      requests.largest = WriteMesh(largest, MeshFormat::kObj);
    }
    requests.query_seconds = order_.quick ? 0.3 : 2.0;
    SubContext part(context_, "requests", 0.6, 0.8);
    GRASPDB_TRY(json, MeasureRequests(requests, part.context()));
    report_["requests"] = std::move(json);
    return {};
  }

  Result<void> RunGrowth() {
    GrowthOrder growth;
    growth.db = db_;
    growth.out = order_.out;
    growth.server_options = order_.server_options;
    growth.category = order_.category;
    growth.mesh = meshes_.front();
    growth.triangles = {1000, 3000, 10'000};
    growth.grasps = {10, 100, 1000};
    growth.stored_grasps = {1000, 10'000};
    growth.query_seconds = order_.quick ? 0.3 : 2.0;
    if (!order_.quick) {
      for (const int more : {30'000, 100'000, 400'000}) {
        growth.triangles.push_back(more);
      }
      growth.grasps.push_back(10'000);
      for (const int more : {100'000, 1'000'000}) {
        growth.stored_grasps.push_back(more);
      }
    }
    SubContext part(context_, "growth", 0.8, 1.0);
    GRASPDB_TRY(grown,
                MeasureGrowth(growth, hand_, decoder_, open_, part.context()));
    std::move(grown.begin(), grown.end(), std::back_inserter(curves_));
    report_["growth"] = Json::array();
    for (const GrowthCurve& curve : curves_) {
      report_["growth"].push_back(EncodeGrowthCurve(curve));
    }
    return WritePlots();
  }

  // One of each, and both axes logarithmic: a power law is a straight line.
  Result<void> WritePlots() const {
    for (const GrowthCurve& curve : curves_) {
      PlotOptions options;
      options.title = curve.name;
      options.x_label = curve.x_label;
      options.y_label = curve.y_label;
      options.logarithmic = true;
      options.alone = true;
      std::string file = "growth " + curve.name + " " + curve.x_label + ".svg";
      for (char& c : file) {
        if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.')
          c = '-';
      }
      GRASPDB_TRY_VOID(WriteFileBytes(
          fs::path(order_.out) / file,
          MakeSvgPlot({{"", "#1f77b4", curve.x, curve.y, true}}, options)));
    }
    return {};
  }

  const SpeedBenchOrder& order_;
  const OpenService& open_;
  ExecutionContext& context_;
  const Decoder decoder_;
  const std::string db_;
  std::shared_ptr<const HandModel> hand_;
  std::vector<TriangleMesh> meshes_;
  std::vector<GrowthCurve> curves_;
  Json report_;
};

std::string FormatSeconds(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.2f} us", 1e6 * seconds);
  if (seconds < 1.0) return fmt::format("{:.2f} ms", 1e3 * seconds);
  return fmt::format("{:.2f} s", seconds);
}

std::string FormatRow(const Json& row) {
  const Json& seconds = row["seconds"];
  const auto time = [](const Json& timing, const char* what) {
    return FormatSeconds(timing[what].get<double>());
  };
  std::string line = fmt::format(
      "{:<42} {:>9} {:>11} {:>11} {:>11} {:>5}", row["name"].get<std::string>(),
      row["triangles"].is_null() ? "" : row["triangles"].dump(),
      time(seconds, "median"), time(seconds, "lower"), time(seconds, "upper"),
      seconds["samples"].get<int>());
  if (!row["goal"].is_null()) {
    line += fmt::format("  goal {}", FormatSeconds(row["goal"].get<double>()));
  }
  if (!row["library"].is_null()) {
    line += fmt::format("  {}: {}, x {:.1f}",
                        row["library"]["call"].get<std::string>(),
                        time(row["library"]["seconds"], "median"),
                        row["library"]["times"].get<double>());
  }
  return line + "\n";
}

std::string FormatTable(const std::string& title, const Json& rows) {
  std::string text =
      fmt::format("\n{:<42} {:>9} {:>11} {:>11} {:>11} {:>5}\n", title,
                  "triangles", "median", "quartile", "quartile", "runs");
  for (const Json& row : rows) text += FormatRow(row);
  return text;
}

}  // namespace

Result<Json> RunSpeedBench(const SpeedBenchOrder& order,
                           const OpenService& open, ExecutionContext& context) {
  return SpeedBench(order, open, context).Run();
}

std::string MakeSpeedReport(const Json& report) {
  const Json& machine = report["machine"];
  std::string text = fmt::format(
      "graspdb {} on {} cores of {}, load {:.2f}\n{} {}\n",
      report["engine_version"].get<std::string>(), machine["cores"].dump(),
      machine["processor"].get<std::string>(), machine["load"].get<double>(),
      machine["compiler"].get<std::string>(),
      machine["flags"].get<std::string>());
  text += FormatTable("primitives, one thread", report["primitives"]);
  text += FormatTable("stages", report["stages"]);
  const Json& requests = report["requests"];
  text += FormatTable("requests over HTTP", requests["rows"]);
  for (const Json& load : requests["queries"]) {
    text += fmt::format(
        "GET /v1/grasps on {} connection(s): p50 {}, p99 {}, {:.0f} a second\n",
        load["connections"].dump(), FormatSeconds(load["p50"].get<double>()),
        FormatSeconds(load["p99"].get<double>()),
        load["per_second"].get<double>());
  }
  text += fmt::format("start {}, peak memory {:.0f} MiB\n\ngrowth\n",
                      FormatSeconds(requests["start_seconds"].get<double>()),
                      requests["peak_bytes"].get<double>() / (1 << 20));
  for (const Json& curve : report["growth"]) {
    text += fmt::format("{}, {} against {}:", curve["name"].get<std::string>(),
                        curve["y_label"].get<std::string>(),
                        curve["x_label"].get<std::string>());
    for (size_t i = 0; i < curve["x"].size(); ++i) {
      text += fmt::format("  {:g}: {:.3g}", curve["x"][i].get<double>(),
                          curve["y"][i].get<double>());
    }
    text += "\n";
  }
  return text;
}

}  // namespace graspdb
