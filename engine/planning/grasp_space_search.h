#pragma once

#include <functional>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/cspace/configuration_space.h"
#include "engine/geometry/solid.h"
#include "engine/hand/hand_shape.h"
#include "engine/parameters/parameters.h"
#include "engine/planning/grasp.h"

namespace graspdb {

/** What a search for grasps found. */
struct GraspSearchResult {
  std::vector<Grasp> grasps;    ///< Distinct, stable, reachable; best ε first.
  int configurations_tried{0};  ///< Hands closed and judged.
  double coverage{0.0};  ///< Share of 26 approach directions with a grasp.
};

/** Searches a part's grasp space by particle swarm optimisation on the hybrid
 measure, Eq. (1). Particles start at `seeds`; a particle's move stops at the
 first contact; at each place the fingers close, and every stable distinct
 grasp is kept. Particles follow the best of their own niche (approach
 direction), where no grasp has fallen through, and one that no longer improves
 starts again: at the next seed, aimed at the part, or near what was found.
 @param whole  When given, grasps must also hold, free of collision, on this.
 Deterministic for a seed on any number of threads; ends early when cancelled.
 @paper{Sec. IV} [Clerc and Kennedy 2002] */
GraspSearchResult SearchGraspSpace(const HandShape& hand, const Solid& part,
                                   const Solid* whole,
                                   const ConfigurationSpace& space,
                                   const std::vector<HandPosture>& seeds,
                                   const Parameters& parameters, uint64_t seed,
                                   ExecutionContext& context);

/** Clerc and Kennedy's constriction: 2 / |2 - φ - √(φ² - 4φ)| with φ the sum of
 both accelerations. @pre φ > 4. */
double CalcConstriction(double phi);

}  // namespace graspdb
