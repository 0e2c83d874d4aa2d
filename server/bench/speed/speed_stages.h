#pragma once

#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "server/bench/speed/speed_rows.h"
#include "server/decode/decode_client.h"
#include "server/jobs/service.h"

namespace graspdb {

/** What the stages of a transfer are measured with. */
struct StageOrder {
  std::string category{"mug"};
  std::vector<TriangleMesh> meshes;  ///< Novel ones of the category.
  int sources{40};                   ///< Source grasps per part.
  int grasps{300};                   ///< Learned once more, of one part.
  int search_seconds{5};             ///< Of a search from scratch.
  uint64_t seed{1};
  StopwatchOptions stopwatch;
};

struct StageReport {
  std::vector<SpeedRow> rows;
  std::vector<GrowthCurve> curves;  ///< Transfer and learning against threads.
};

/** Times decoding in the helper, segmentation, alignment, the contact map,
 replanning and assembly of one grasp, and learning: all that a request is made
 of, each alone and on one thread; the last two on two, too.
 @pre The category's first example has been learned with the default hand.
 @retval kInternal when two threads find other grasps than one; kCancelled. */
Result<StageReport> MeasureStages(const Service& service,
                                  const Decoder& decoder,
                                  const StageOrder& order,
                                  ExecutionContext& context);

/** The mesh with so many triangles and the same shape: cut finer, then
 decimated by the decoding helper. @retval as Decoder::Decode(). */
Result<TriangleMesh> ResampleMesh(const Decoder& decoder,
                                  const TriangleMesh& mesh, int triangles);

}  // namespace graspdb
