#pragma once

#include <memory>
#include <vector>

#include "engine/hand/hand_model.h"
#include "server/bench/speed/speed_rows.h"

namespace graspdb {

/** Times each hot function of the engine, and the plain library call that does
 the same where there is one.
 @param meshes  One object, coarse to fine; what does not depend on triangles is
   measured on the middle one. */
std::vector<SpeedRow> MeasurePrimitives(std::shared_ptr<const HandModel> hand,
                                        const std::vector<TriangleMesh>& meshes,
                                        const StopwatchOptions& options);

}  // namespace graspdb
