#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "server/codec/json.h"
#include "server/jobs/service.h"

namespace graspdb {

/** Where the swarm's particles start, on one part for the same time each: at
 the classifier's support vectors (whose learning counts), half of them there
 and half aimed at the surface, all aimed, or anywhere that is free.
 @param seconds  Of a clock, for each of the four.
 @returns [{"category", "part", "seeding", "seconds", "tried", "grasps",
 "curve":
   [{"seconds", "grasps"}]}], not reproducible, since time ends each.
 @retval kCancelled. */
Result<Json> CompareSeeding(Service& service, const StoredGraspSpace& space,
                            const Parameters& parameters, double seconds,
                            uint64_t seed, ExecutionContext& context);

}  // namespace graspdb
