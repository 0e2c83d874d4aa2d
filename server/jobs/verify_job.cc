#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <utility>

#include "engine/base/parallel.h"
#include "server/jobs/service.h"

namespace graspdb {
namespace {

Error MakeCancelled() {
  return {ErrorCode::kCancelled, "The verification was cancelled."};
}

// Grasps of one object by one hand: one scene.
using Group = std::vector<VerifiedGrasp>;

Result<std::vector<Group>> CollectGroups(const Store& store,
                                         const VerifyOrder& order, bool keep,
                                         const ExecutionContext& context) {
  std::map<std::pair<std::string, std::string>, Group> groups;
  int count = 0;
  GraspQuery query = order.query;
  query.page = {1000, ""};
  do {
    if (context.Cancelled()) return MakeCancelled();
    GRASPDB_TRY(page, store.QueryGrasps(query));
    for (StoredGrasp& grasp : page.items) {
      if (grasp.physical && keep && !order.again) continue;
      if (order.limit > 0 && count == order.limit) break;
      ++count;
      Group& group = groups[{grasp.object_id, grasp.hand}];
      group.push_back({std::move(grasp), {}});
    }
    query.page.cursor = page.next_cursor;
  } while (!query.page.cursor.empty() &&
           (order.limit == 0 || count < order.limit));
  std::vector<Group> list;
  for (auto& [key, group] : groups) list.push_back(std::move(group));
  return list;
}

}  // namespace

Result<std::vector<VerifiedGrasp>> Service::VerifyGrasps(
    const VerifyOrder& order, ExecutionContext& context,
    const VerifyOptions& options) {
  GRASPDB_TRY(groups, CollectGroups(*store_, order, options.keep, context));
  size_t total = 0;
  for (const Group& group : groups) total += group.size();
  std::atomic<size_t> done{0};
  std::mutex progress_mutex;
  std::vector<VerifiedGrasp> verified;
  for (Group& group : groups) {
    const StoredGrasp& first = group.front().grasp;
    GRASPDB_TRY(meshes, store_->ReadObjectMeshes(first.object_id));
    GRASPDB_TRY(hand, FindHandModel(first.hand, context));
    // A simulator each, since one judges one grasp at a time.
    RunInArena(options_.threads, [&] {
      const int workers =
          std::min(CountThreads(), static_cast<int>(group.size()));
      ParallelFor(workers, [&](int worker) {
        // The working mesh; the pieces stand out by up to 1 mm anyhow.
        GraspSimulator simulator(hand, meshes.work, options.test);
        for (size_t i = static_cast<size_t>(worker); i < group.size();
             i += static_cast<size_t>(workers)) {
          if (context.Cancelled()) return;
          group[i].verdict = simulator.Judge(group[i].grasp.grasp);
          const double share =
              static_cast<double>(++done) / static_cast<double>(total);
          const std::lock_guard lock(progress_mutex);
          context.ReportProgress("verify", share);
        }
      });
    });
    if (context.Cancelled()) return MakeCancelled();
    std::vector<std::pair<std::string, double>> scores;
    for (VerifiedGrasp& one : group) {
      one.grasp.physical = one.verdict.CalcScore();
      scores.emplace_back(one.grasp.id, *one.grasp.physical);
    }
    if (options.keep) GRASPDB_TRY_VOID(store_->SetPhysical(scores));
    std::move(group.begin(), group.end(), std::back_inserter(verified));
  }
  return verified;
}

}  // namespace graspdb
