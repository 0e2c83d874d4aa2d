#include "server/bench/paper_bench.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "engine/base/contract.h"
#include "server/bench/bench_items.h"
#include "server/bench/bench_rows.h"
#include "server/bench/html_report.h"
#include "server/bench/published_results.h"
#include "server/bench/row_files.h"
#include "server/bench/scanned_cloud.h"
#include "server/bench/seeding_comparison.h"
#include "server/codec/input_json.h"
#include "server/codec/parameters_json.h"
#include "server/files.h"
#include "server/ids.h"
#include "server/jobs/data_folder.h"
#include "server/jobs/sub_context.h"

namespace graspdb {
namespace {

namespace fs = std::filesystem;

constexpr double kLearnShare = 0.3;  // Of a variant's progress.
constexpr int kQuickSources = 8;
constexpr double kSeedingSeconds = 10.0;
// Of the reconstructed mug (Table III).
constexpr int kBodyPoints = 1000;
constexpr int kOtherPoints = 500;

// Which simulated tests judge assembled grasps.
enum class Tests { kNone, kSixPushes, kAll };

// Without what differs between variants.
class PaperBench {
 public:
  PaperBench(const PaperBenchOrder& order, const OpenService& open,
             ExecutionContext& context)
      : order_(order),
        open_(open),
        context_(context),
        row_files_(fs::path(order.out) / "rows") {}

  Result<Json> Run() {
    GRASPDB_TRY_VOID(row_files_.MakeFolder());
    GRASPDB_TRY(items, CollectBenchItems(order_));
    Json report = DescribeRun();
    const size_t all = order_.variants.size() + order_.ablations.size();
    size_t done = 0;
    report["variants"] = Json::array();
    report["ablations"] = Json::array();
    for (const bool ablation : {false, true}) {
      for (const BenchVariant& variant :
           ablation ? order_.ablations : order_.variants) {
        const double begin =
            static_cast<double>(done) / static_cast<double>(all);
        ++done;
        const double end = static_cast<double>(done) / static_cast<double>(all);
        SubContext part(context_, variant.name, begin, end);
        GRASPDB_TRY(result, RunVariant(variant, items,
                                       !order_.physical ? Tests::kNone
                                       : ablation       ? Tests::kSixPushes
                                                        : Tests::kAll,
                                       part.context()));
        report[ablation ? "ablations" : "variants"].push_back(
            std::move(result));
        // What is there so far may be looked at.
        GRASPDB_TRY_VOID(WriteReports(report));
      }
    }
    return report;
  }

 private:
  int sources() const {
    return order_.quick ? std::min(kQuickSources, order_.sources)
                        : order_.sources;
  }

  double seeding_seconds() const {
    return order_.seeding_seconds.value_or(order_.quick ? 0.0
                                                        : kSeedingSeconds);
  }

  Result<void> WriteReports(const Json& report) const {
    GRASPDB_TRY_VOID(WriteFileBytes(fs::path(order_.out) / "paper.json",
                                    report.dump(1) + "\n"));
    return WriteFileBytes(fs::path(order_.out) / "paper.html",
                          MakeHtmlReport(report));
  }

  Json DescribeRun() const {
    Json report;
    report["bench"] = "paper";
    report["engine_version"] = EngineVersion();
    report["simulator"] = SimulatorVersion();
    report["machine"] = {{"cores", std::thread::hardware_concurrency()},
                         {"compiler", __VERSION__}};
    report["seed"] = order_.seed;
    report["sources_per_part"] = sources();
    report["quick"] = order_.quick;
    report["tests"] = {{"six_pushes", PushTest().name},
                       {"net_displacement", MakeNetDisplacementTest().name},
                       {"lift", MakeLiftTest().name}};
    return report;
  }

  Result<Json> RunVariant(const BenchVariant& variant,
                          const std::vector<BenchItem>& items, Tests tests,
                          ExecutionContext& context) {
    GRASPDB_TRY(service,
                open_(MakeLearningPath(order_.out, variant.parameters)));
    PopulateOrder populate;
    populate.folder = order_.data;
    populate.categories = order_.categories;
    populate.parameters = variant.parameters;
    populate.seed = order_.seed;
    SubContext learning(context, "learn", 0.0, kLearnShare);
    GRASPDB_TRY(spaces, Populate(*service, populate, learning.context()));

    Json result;
    result["name"] = variant.name;
    result["parameters"] = Json::parse(ParametersToJson(variant.parameters));
    result["learning"] = Json::array();
    for (const StoredGraspSpace& space : spaces) {
      GRASPDB_TRY(row, DescribeLearning(*service, space));
      result["learning"].push_back(std::move(row));
    }
    if (tests == Tests::kAll && seeding_seconds() > 0.0) {
      GRASPDB_TRY(seeding, RunSeeding(*service, variant, spaces, context));
      result["seeding"] = std::move(seeding);
    }
    result["rows"] = Json::array();
    for (size_t i = 0; i < items.size(); ++i) {
      const auto at = [&](size_t k) {
        return kLearnShare + (1.0 - kLearnShare) * static_cast<double>(k) /
                                 static_cast<double>(items.size());
      };
      SubContext part(context, items[i].category + " " + items[i].name, at(i),
                      at(i + 1));
      GRASPDB_TRY(rows,
                  RunItem(*service, variant, items[i], tests, part.context()));
      for (Json& row : rows) result["rows"].push_back(std::move(row));
    }
    result["pooled"] = Json::object();
    for (const char* group : {"paper", "further", "cloud", "objects"}) {
      std::vector<Json> rows;
      for (const Json& row : result["rows"]) {
        if (row["group"] == group) rows.push_back(row);
      }
      if (!rows.empty()) result["pooled"][group] = PoolRows(rows);
    }
    return result;
  }

  // Ways to seed the swarm, part by part, or what was found of them before.
  Result<Json> RunSeeding(Service& service, const BenchVariant& variant,
                          const std::vector<StoredGraspSpace>& spaces,
                          ExecutionContext& context) {
    Json all = Json::array();
    for (const StoredGraspSpace& space : spaces) {
      const std::string key = MakeContentId(fmt::format(
          "{} {} {} {} seeding {}", EngineVersion(), space.parameters_hash,
          order_.seed, seeding_seconds(), space.part_label));
      const std::string part = space.category + " " + space.part_label;
      const std::string name = variant.name + " seeding " + part;
      std::optional<Json> rows = row_files_.Read(name, key);
      if (!rows) {
        SubContext comparing(context, "seeding " + part, kLearnShare,
                             kLearnShare);
        GRASPDB_TRY(compared, CompareSeeding(service, space, variant.parameters,
                                             seeding_seconds(), order_.seed,
                                             comparing.context()));
        GRASPDB_TRY_VOID(row_files_.Write(name, key, compared));
        rows = std::move(compared);
      }
      for (Json& row : *rows) all.push_back(std::move(row));
    }
    return all;
  }

  static Result<Json> DescribeLearning(Service& service,
                                       const StoredGraspSpace& space) {
    GRASPDB_TRY(part, service.store().FindPart(space.part_id));
    GRASPDB_TRY(learned, service.store().ReadGraspSpace(space.id));
    GRASPDB_TRY(solids, service.store().ReadSolids({part}));
    return MakeLearningRow(space, static_cast<int>(part.faces.size()),
                           learned.grasps, solids.front().solid_O);
  }

  // All rows of one object: read, when they were made before for the same
  // question, else made and written.
  Result<std::vector<Json>> RunItem(Service& service,
                                    const BenchVariant& variant,
                                    const BenchItem& item, Tests tests,
                                    ExecutionContext& context) {
    const std::string key = MakeContentId(fmt::format(
        "{} {} {} {} {} {} {} {}", EngineVersion(), variant.name,
        ParametersToJson(variant.parameters), order_.seed, sources(),
        static_cast<int>(tests), item.name, MakeContentId(item.mesh.bytes)));
    const std::string name =
        variant.name + " " + item.group + " " + item.category + " " + item.name;
    if (const auto known = row_files_.Read(name, key)) {
      return known->get<std::vector<Json>>();
    }
    GRASPDB_TRY(rows, MakeRows(service, variant, item, tests, context));
    for (Json& row : rows) {
      row["group"] = item.group;
      row["number"] = item.number;
      row["category"] = item.category;
      row["object"] = item.name;
    }
    GRASPDB_TRY_VOID(row_files_.Write(name, key, rows));
    return rows;
  }

  Result<std::vector<Json>> MakeRows(Service& service,
                                     const BenchVariant& variant,
                                     const BenchItem& item, Tests tests,
                                     ExecutionContext& context) {
    TransferOrder transfer;
    transfer.mesh = item.mesh;
    transfer.category = item.category;
    transfer.parameters = variant.parameters;
    transfer.seed = order_.seed;
    transfer.sources = sources();
    if (item.group == "cloud") {
      GRASPDB_TRY(points, ScanMug(service, item));
      transfer.mesh.bytes = FormatXyz(points);
    }
    SubContext transferring(context, "", 0.0,
                            tests == Tests::kNone ? 1.0 : 0.2);
    const auto answer =
        service.TransferGrasps(transfer, transferring.context());
    if (!answer) {
      if (answer.error().code == ErrorCode::kCancelled) return answer.error();
      // An object that is refused is so many grasps that failed.
      GRASPDB_TRY(category, service.store().FindCategory(item.category));
      std::vector<Json> rows;
      for (const CategoryPart& part : category.parts) {
        rows.push_back(MakeFailedRow(part.label, sources(), answer.error()));
      }
      return rows;
    }
    GRASPDB_TRY(further,
                Simulate(service, answer->transfer.id, tests, context));
    GRASPDB_TRY(grasps, ReadGrasps(service, answer->transfer.id));
    std::vector<Json> rows;
    GRASPDB_TRY(category, service.store().FindCategory(item.category));
    for (const CategoryPart& wanted : category.parts) {
      const auto part = std::find_if(
          answer->parts.begin(), answer->parts.end(),
          [&](const StoredPart& one) { return one.label == wanted.label; });
      // A part that was not found is so many grasps that failed, too.
      rows.push_back(
          part == answer->parts.end()
              ? MakeFailedRow(wanted.label, sources(),
                              {ErrorCode::kNotInCategory,
                               "no " + wanted.label + " was found", ""})
              : MakeTransferRow(answer->transfer, *part, grasps, further));
      rows.back()["similarity"] = answer->transfer.similarity;
      rows.back()["warnings"] = answer->transfer.warnings;
    }
    return rows;
  }

  // Points of the mesh whose cloud it is.
  Result<std::vector<Eigen::Vector3d>> ScanMug(Service& service,
                                               const BenchItem& item) const {
    GRASPDB_TRY(objects, service.store().ListObjects(
                             {item.category, ObjectRole::kNovel}, {1000, ""}));
    const std::string name = item.name.substr(0, item.name.find(", "));
    for (const StoredObject& object : objects.items) {
      if (object.file_name.substr(0, object.file_name.find('.')) != name) {
        continue;
      }
      GRASPDB_TRY(meshes, service.store().ReadObjectMeshes(object.id));
      GRASPDB_TRY(category, service.store().FindCategory(item.category));
      ScanOptions scan;
      scan.seed = order_.seed;
      for (const CategoryPart& part : category.parts) {
        scan.points_by_label.push_back(part.label == "body" ? kBodyPoints
                                                            : kOtherPoints);
      }
      if (item.name.ends_with("one side")) {
        // From above and beside, so that the handle is in sight.
        scan.camera_O = Eigen::Vector3d(1.0, 2.0, 1.0).normalized();
      }
      return ScanSurface(meshes.canonical, meshes.canonical_labels, scan);
    }
    return Error{ErrorCode::kNotFound, "There is no " + name + " to scan.", ""};
  }

  // The stored test, and the two that are published for other hands.
  static Result<TestScores> Simulate(Service& service,
                                     const std::string& transfer_id,
                                     Tests wanted, ExecutionContext& context) {
    TestScores further;
    if (wanted == Tests::kNone) return further;
    VerifyOrder verify;
    verify.query.transfer_id = transfer_id;
    verify.query.stage = GraspStage::kAssembly;
    SubContext pushing(context, "six pushes", 0.2, 0.6);
    GRASPDB_TRY_VOID(service.VerifyGrasps(verify, pushing.context()));
    if (wanted != Tests::kAll) return further;
    const std::pair<const char*, PushTest> tests[] = {
        {"net_displacement", MakeNetDisplacementTest()},
        {"lift", MakeLiftTest()}};
    double begin = 0.6;
    for (const auto& [key, test] : tests) {
      SubContext testing(context, key, begin, begin + 0.2);
      begin += 0.2;
      GRASPDB_TRY(verified, service.VerifyGrasps(verify, testing.context(),
                                                 {test, false}));
      for (const VerifiedGrasp& one : verified) {
        further[key][one.grasp.id] = one.verdict.CalcScore();
      }
    }
    return further;
  }

  // Of both stages, in an order that no simulator has had a part in.
  static Result<std::vector<StoredGrasp>> ReadGrasps(
      Service& service, const std::string& transfer_id) {
    std::vector<StoredGrasp> grasps;
    GraspQuery query;
    query.transfer_id = transfer_id;
    query.page.limit = 1000;
    do {
      GRASPDB_TRY(page, service.store().QueryGrasps(query));
      std::move(page.items.begin(), page.items.end(),
                std::back_inserter(grasps));
      query.page.cursor = page.next_cursor;
    } while (!query.page.cursor.empty());
    const auto merit = [](const StoredGrasp& grasp) {
      return std::pair(grasp.grip.value_or(0.0), grasp.grasp.quality.epsilon);
    };
    std::stable_sort(grasps.begin(), grasps.end(),
                     [&](const StoredGrasp& a, const StoredGrasp& b) {
                       return merit(a) > merit(b);
                     });
    return grasps;
  }

  const PaperBenchOrder& order_;
  const OpenService& open_;
  ExecutionContext& context_;
  const RowFiles row_files_;
};

}  // namespace

std::string MakeLearningPath(const std::string& out,
                             const Parameters& parameters) {
  const std::string id =
      MakeContentId(ParametersToJson(SelectForLearning(parameters)));
  return fs::path(out) / (id + ".db");
}

Result<Json> RunPaperBench(const PaperBenchOrder& order,
                           const OpenService& open, ExecutionContext& context) {
  return PaperBench(order, open, context).Run();
}

}  // namespace graspdb
