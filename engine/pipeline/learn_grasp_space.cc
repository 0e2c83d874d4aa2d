#include <chrono>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/cspace/active_learner.h"
#include "engine/grasp_engine.h"
#include "engine/pipeline/part_clearance.h"
#include "engine/planning/grasp_evaluator.h"
#include "engine/planning/grasp_space_search.h"
#include "engine/quality/epsilon_quality.h"
#include "engine/quality/wrench_space.h"

namespace graspdb {
namespace {

// What the streams of random numbers are for.
enum Stream : uint64_t { kConfigurationSpace, kSwarm };

Result<GraspSpace> LearnInArena(const LearnRequest& request,
                                ExecutionContext& context) {
  const Parameters& parameters = request.parameters;
  context.ReportProgress("preparing", 0.0);
  const HandShape& hand = *request.hand;
  const Solid part(request.part_E.solid_O, request.part_E.num_surface_faces);
  std::optional<Solid> whole;
  if (parameters.swarm.hold_on_whole) whole.emplace(request.whole_E.mesh_O);

  // Sec. IV: approximate the configuration space …
  context.ReportProgress("configuration space", 0.05);
  const auto start = ExecutionContext::Clock::now();
  const ConfigurationSpace space(hand, part);
  GRASPDB_TRY(learned,
              LearnConfigurationSpace(
                  space, parameters.active_learning,
                  DeriveSeed(request.seed, {kConfigurationSpace}), context));

  const std::chrono::duration<double> learning =
      ExecutionContext::Clock::now() - start;

  // … and search it for grasps from its boundary.
  ExecutionContext swarm_context(
      [&context](const std::string& stage, double share) {
        context.ReportProgress(stage, 0.2 + 0.75 * share);
      });
  swarm_context.set_parent(&context);
  GraspSearchResult found =
      SearchGraspSpace(hand, part, whole ? &*whole : nullptr, space,
                       learned.free_support_vectors, parameters,
                       DeriveSeed(request.seed, {kSwarm}), swarm_context);

  if (context.Cancelled()) {
    return Error{ErrorCode::kCancelled, "learning was cancelled"};
  }
  GraspSpace result;
  result.grasps = std::move(found.grasps);
  result.curve = std::move(learned.rounds);
  for (const HandPosture& posture : learned.free_support_vectors) {
    result.support_vectors.push_back(
        {posture.X_OH, hand.model().CalcCoupledJoints(posture.actuators)});
  }
  result.configurations_tried = found.configurations_tried;
  result.coverage = found.coverage;
  result.configuration_space_seconds = learning.count();
  const PartSurfaces parts(request.whole_E);
  result.clearances.resize(result.grasps.size());
  ParallelFor(static_cast<int>(result.grasps.size()), [&](int i) {
    const auto g = static_cast<size_t>(i);
    Grasp& grasp = result.grasps[g];
    grasp.quality.hybrid = CalcHybrid(hand, grasp, part, parameters);
    grasp.quality.volume = CalcWrenchVolume(
        CalcContactWrenches(grasp.contacts, part.mass(), parameters.contact));
    result.clearances[g] = parts.CalcClearances(hand, grasp.configuration);
  });
  context.ReportProgress("done", 1.0);
  return result;
}

}  // namespace

Result<GraspSpace> Learn(const LearnRequest& request,
                         ExecutionContext& context) {
  return RunWithThreads(request.threads,
                        [&] { return LearnInArena(request, context); });
}

}  // namespace graspdb
