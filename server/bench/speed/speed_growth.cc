#include "server/bench/speed/speed_growth.h"

#include <algorithm>
#include <filesystem>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "engine/base/parallel.h"
#include "engine/base/random.h"
#include "engine/planning/grasp_evaluator.h"
#include "server/bench/speed/server_process.h"
#include "server/bench/speed/speed_requests.h"
#include "server/bench/speed/speed_scene.h"
#include "server/bench/speed/speed_stages.h"
#include "server/codec/mesh_writer.h"
#include "server/ids.h"
#include "server/jobs/segmentation.h"

namespace graspdb {
namespace {

constexpr int kGraspsPerTransfer = 10'000;  // Of those that are copied.

class GrowthBench {
 public:
  GrowthBench(const GrowthOrder& order, std::shared_ptr<const HandModel> hand,
              const Decoder& decoder, const OpenService& open,
              ExecutionContext& context)
      : order_(order),
        hand_(std::move(hand)),
        decoder_(decoder),
        open_(open),
        context_(context) {}

  Result<std::vector<GrowthCurve>> Run() {
    GRASPDB_TRY_VOID(GrowTriangles());
    GrowGrasps();
    GRASPDB_TRY_VOID(GrowStoredGrasps());
    return std::move(curves_);
  }

 private:
  Result<void> Go(const std::string& stage, double share) {
    context_.ReportProgress(stage, share);
    if (!context_.Cancelled()) return {};
    return Error{ErrorCode::kCancelled, "The bench was cancelled."};
  }

  Result<void> GrowTriangles() {
    GRASPDB_TRY(service, open_(order_.db));
    GRASPDB_TRY(category, service->store().FindCategory(order_.category));
    GrowthCurve decode{"decode", "triangles", "s", {}, {}};
    GrowthCurve segment{"segment", "triangles", "s", {}, {}};
    GrowthCurve solid{"solid with distance field", "triangles", "s", {}, {}};
    for (const int triangles : order_.triangles) {
      GRASPDB_TRY_VOID(Go(fmt::format("{} triangles", triangles), 0.1));
      GRASPDB_TRY(mesh, ResampleMesh(decoder_, order_.mesh, triangles));
      const std::string text = WriteMesh(mesh, MeshFormat::kPly);
      DecodeRequest request;
      request.format = MeshFormat::kPly;
      double start = Now();
      GRASPDB_TRY(decoded, decoder_.Decode(
                               {reinterpret_cast<const uint8_t*>(text.data()),
                                text.size()},
                               request));
      Add(decode, mesh.num_triangles(), Now() - start);
      ObjectMeshes meshes;
      meshes.canonical = std::move(decoded.mesh_O);
      meshes.work = std::move(decoded.work_O);
      start = Now();
      GRASPDB_TRY_VOID(SegmentByExamples(service->store(), category,
                                         category.segmentation, meshes, "", 1,
                                         context_));
      Add(segment, mesh.num_triangles(), Now() - start);
      start = Now();
      const Solid built(mesh);
      Add(solid, mesh.num_triangles(), Now() - start);
    }
    for (GrowthCurve* curve : {&decode, &segment, &solid}) {
      curves_.push_back(std::move(*curve));
    }
    return {};
  }

  static void Add(GrowthCurve& curve, double x, double y) {
    curve.x.push_back(x);
    curve.y.push_back(y);
  }

  void GrowGrasps() {
    const SpeedScene scene = MakeSpeedScene(hand_, order_.mesh);
    GrowthCurve judge{
        "closing, contacts and eps, all cores", "grasps", "s", {}, {}};
    for (const int count : order_.grasps) {
      const double start = Now();
      ParallelFor(count, [&](int i) {
        const Grasp& one =
            scene.grasps[static_cast<size_t>(i) % scene.grasps.size()];
        CloseAndJudge(scene.hand, one.configuration.X_OH, one.q_pregrasp,
                      scene.solid, scene.parameters);
      });
      Add(judge, count, Now() - start);
    }
    curves_.push_back(std::move(judge));
  }

  Result<void> GrowStoredGrasps() {
    const std::string grown = std::filesystem::path(order_.out) / "grown.db";
    RemoveDatabase(grown);
    {
      GRASPDB_TRY(service, open_(order_.db));
      GRASPDB_TRY_VOID(service->store().WriteBackup(grown));
    }
    GrowthCurve p50{"query by category, median", "stored grasps", "s", {}, {}};
    GrowthCurve p99{"query by category, p99", "stored grasps", "s", {}, {}};
    GrowthCurve busy{
        "query by category, 16 connections, p99", "stored grasps", "s", {}, {}};
    GrowthCurve rate{"queries, 16 connections", "stored grasps", "1/s", {}, {}};
    GrowthCurve start{"start", "stored grasps", "s", {}, {}};
    GrowthCurve memory{"peak memory", "stored grasps", "MiB", {}, {}};
    for (size_t i = 0; i < order_.stored_grasps.size(); ++i) {
      const int wanted = order_.stored_grasps[i];
      GRASPDB_TRY_VOID(
          Go(fmt::format("{} stored grasps", wanted),
             0.4 + 0.6 * static_cast<double>(i) /
                       static_cast<double>(order_.stored_grasps.size())));
      GRASPDB_TRY(count, StoreCopies(grown, wanted));
      GRASPDB_TRY(server, ServerProcess::Start(grown, order_.server_options));
      Add(start, count, server->start_seconds());
      GRASPDB_TRY(alone, MeasureQueries(server->port(), order_.category, 1,
                                        order_.query_seconds));
      GRASPDB_TRY(many, MeasureQueries(server->port(), order_.category, 16,
                                       order_.query_seconds));
      Add(p50, count, alone.p50);
      Add(p99, count, alone.p99);
      Add(busy, count, many.p99);
      Add(rate, count, many.per_second);
      Add(memory, count,
          static_cast<double>(server->CalcPeakMemory()) / (1 << 20));
    }
    for (GrowthCurve* curve : {&p50, &p99, &busy, &rate, &start, &memory}) {
      curves_.push_back(std::move(*curve));
    }
    return {};
  }

  // Until there are so many. @returns how many there are.
  Result<double> StoreCopies(const std::string& db, int wanted) {
    GRASPDB_TRY(service, open_(db));
    Store& store = service->store();
    GRASPDB_TRY(counts, store.Count());
    GraspQuery query;
    query.category = order_.category;
    query.stage = GraspStage::kAssembly;
    query.page.limit = 1000;
    GRASPDB_TRY(page, store.QueryGrasps(query));
    if (page.items.empty()) {
      return Error{ErrorCode::kInternal, "There is no grasp to copy."};
    }
    GRASPDB_TRY(transfer, store.FindTransfer(page.items.front().transfer_id));
    transfer.attempts.clear();
    transfer.contact_maps.clear();
    Random random(static_cast<uint64_t>(wanted));
    int64_t count = counts.grasps;
    while (count < wanted) {
      transfer.id = MakeContentId(fmt::format("copies from {} on", count));
      std::vector<StoredGrasp> copies;
      while (count < wanted && copies.size() < kGraspsPerTransfer) {
        const auto index = static_cast<int>(copies.size());
        copies.push_back(
            page.items[static_cast<size_t>(count) % page.items.size()]);
        StoredGrasp& copy = copies.back();
        copy.id = MakeGraspId(transfer.id, copy.stage, index);
        copy.index = index;
        copy.transfer_id = transfer.id;
        copy.grasp.quality.epsilon *= random.NextUniform(0.5, 1.0);
        ++count;
      }
      GRASPDB_TRY_VOID(store.InsertTransfer(transfer, copies));
    }
    return static_cast<double>(count);
  }

  const GrowthOrder& order_;
  const std::shared_ptr<const HandModel> hand_;
  const Decoder& decoder_;
  const OpenService& open_;
  ExecutionContext& context_;
  std::vector<GrowthCurve> curves_;
};

}  // namespace

Result<std::vector<GrowthCurve>> MeasureGrowth(
    const GrowthOrder& order, std::shared_ptr<const HandModel> hand,
    const Decoder& decoder, const OpenService& open,
    ExecutionContext& context) {
  return GrowthBench(order, std::move(hand), decoder, open, context).Run();
}

}  // namespace graspdb
