#include "server/bench/seeding_comparison.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/base/random.h"
#include "engine/cspace/active_learner.h"
#include "engine/planning/grasp_space_search.h"
#include "server/jobs/sub_context.h"

namespace graspdb {
namespace {

using Clock = ExecutionContext::Clock;

struct Seeding {
  const char* name;
  double aimed_share;
  double uniform_share;
};
constexpr Seeding kSeedings[] = {{"support vectors", 0.0, 0.0},
                                 {"both", 0.5, 0.0},
                                 {"aimed at the surface", 1.0, 0.0},
                                 {"uniform", 0.0, 1.0}};
constexpr double kShare = 1.0 / std::size(kSeedings);
// Never reached, so that the swarm's progress tells how many were found.
constexpr int kNoTarget = 100'000;
constexpr int kNoEnd = 1'000'000;

double CalcSeconds(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

Result<Json> CompareSeeding(Service& service, const StoredGraspSpace& record,
                            const Parameters& parameters, double seconds,
                            uint64_t seed, ExecutionContext& context) {
  GRASPDB_TRY(model, service.FindHandModel(record.hand));
  GRASPDB_TRY(meshes, service.store().ReadObjectMeshes(record.object_id));
  GRASPDB_TRY(stored, service.store().FindPart(record.part_id));
  GRASPDB_TRY(solids, service.store().ReadSolids({stored}));
  const Part& part_E = solids.front();
  const HandShape hand(model);
  const Solid part(part_E.solid_O, part_E.num_surface_faces);
  const Solid whole(meshes.work);
  const ConfigurationSpace space(hand, part);

  Json rows = Json::array();
  double begin = 0.0;
  for (const Seeding& seeding : kSeedings) {
    SubContext share(context, seeding.name, begin, begin + kShare);
    begin += kShare;
    Parameters changed = parameters;
    changed.swarm.aimed_share = seeding.aimed_share;
    changed.swarm.uniform_share = seeding.uniform_share;
    changed.swarm.target_grasps = kNoTarget;
    changed.swarm.iterations = kNoEnd;
    const auto start = Clock::now();
    Json curve = Json::array();
    ExecutionContext timed([&](const std::string& stage, double found) {
      if (stage != "swarm") return;
      curve.push_back({{"seconds", CalcSeconds(start)},
                       {"grasps", std::lround(found * kNoTarget)}});
      share.context().ReportProgress(stage, CalcSeconds(start) / seconds);
    });
    timed.set_parent(&share.context());
    timed.set_deadline(start + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(seconds)));
    std::optional<GraspSearchResult> found;
    RunInArena(service.options().threads, [&] {
      std::vector<HandPosture> seeds;
      if (seeding.aimed_share + seeding.uniform_share < 1.0) {
        auto learned = LearnConfigurationSpace(
            space, parameters.active_learning, DeriveSeed(seed, {0}), timed);
        if (!learned) return;
        seeds = std::move(learned->free_support_vectors);
      }
      found = SearchGraspSpace(
          hand, part, changed.swarm.hold_on_whole ? &whole : nullptr, space,
          seeds, changed, DeriveSeed(seed, {1}), timed);
    });
    if (share.context().Cancelled()) {
      return Error{ErrorCode::kCancelled, "The comparison was cancelled."};
    }
    Json row;
    row["category"] = record.category;
    row["part"] = record.part_label;
    row["seeding"] = seeding.name;
    row["seconds"] = seconds;
    row["tried"] = found ? found->configurations_tried : 0;
    row["grasps"] = found ? found->grasps.size() : 0;
    row["coverage"] = found ? found->coverage : 0.0;
    row["curve"] = std::move(curve);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace graspdb
