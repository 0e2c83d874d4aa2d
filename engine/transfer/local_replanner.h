#pragma once

#include <cstdint>
#include <optional>

#include "engine/base/parallel.h"
#include "engine/geometry/solid.h"
#include "engine/hand/hand_shape.h"
#include "engine/parameters/parameters.h"
#include "engine/planning/grasp.h"
#include "engine/transfer/transfer_outcome.h"
#include "engine/transfer/transfer_task.h"

namespace graspdb {

struct ReplanResult {
  TransferOutcome outcome{TransferOutcome::kNoContact};
  std::optional<Grasp> grasp;  ///< Set when the outcome is kSucceeded.
};

/** What replanning is to reach. */
struct ReplanOptions {
  /** Tries, at most, for the best grasp around the first one that counts … */
  int climb_samples{0};
  int searches{1};  ///< … and how often all that, until one is likely to hold.
  bool grip{true};  ///< Whether disturbed copies choose; else ε does.
  /** Whether the first sure grasp will do: one that beats open-close and of
   which, if copies choose, enough_grip of them are held. */
  bool until_sure{false};
  double epsilon_to_beat{0.0};  ///< What open-close reaches.
  /** Whether to go on; may be empty. Once it says no, the result is the best
   so far. */
  Wanted wanted{};
};

/** Local replanning: simulated annealing on Eq. (6), from T* X_EH and, with
 aimed_starts, from FitWrist(). Each sample that collides is replaced by up to
 extra_samples others; each free one closes its fingers, its pre-grasp timed by
 TimeFingers(). Of the stable, reachable, near-enough grasps the answer is the
 one with the largest ε, or, with grip_copies, the one that the most perturbed
 copies hold, up to enough_grip, where an ε that does not beat open-close costs
 behind_cost of them; then ε. With grip_copies up to options.climb_samples more
 are then tried around the best, and while fewer than likely_grip of the copies
 are held all that is repeated, options.searches in all. With
 options.until_sure the starts are looked at closely by their value of Eq. (6),
 and the first sure grasp ends everything. Deterministic for a seed.
 @paper{Sec. V-B} */
ReplanResult Replan(const HandShape& hand, const TransferTask& task,
                    const Solid& solid, const Parameters& parameters,
                    uint64_t seed, const ReplanOptions& options = {});

/** How well a task's starts do before any refit and search: the least value of
 Eq. (6), infinity when all collide. Tasks with little of it need little
 replanning. */
double CalcPromise(const HandShape& hand, const TransferTask& task,
                   const Solid& solid, const Parameters& parameters);

/** Assembly: the grasp of the part on the whole object, replanned there from
 where it is and, with aimed_starts, from T* X_EH and FitWrist(). Without them,
 a palm that collides ends it, as in the paper.
 @paper{Sec. V-C} */
ReplanResult Assemble(const HandShape& hand, const TransferTask& task,
                      const Grasp& transferred, const Solid& whole,
                      const Parameters& parameters, uint64_t seed,
                      const ReplanOptions& options = {});

}  // namespace graspdb
