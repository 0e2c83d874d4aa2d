#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "engine/hand/hand_model.h"
#include "server/bench/paper_bench.h"
#include "server/bench/speed/speed_rows.h"
#include "server/decode/decode_client.h"

namespace graspdb {

/** How cost grows with what there is. */
struct GrowthOrder {
  std::string db;   ///< With grasps that were transferred; is copied.
  std::string out;  ///< Folder for the copy.
  std::vector<std::string> server_options;
  std::string category{"mug"};
  TriangleMesh mesh;  ///< Of the category.
  std::vector<int> triangles;
  std::vector<int> grasps;
  std::vector<int> stored_grasps;
  double query_seconds{2.0};
};

/** Decoding, solids and segmentation against triangles; judging against grasps;
 start, memory and queries of a server against stored grasps, which are copies
 of real ones of other quality.
 @pre The order's numbers ascend.
 @retval kInternal when the server fails; kCancelled. */
Result<std::vector<GrowthCurve>> MeasureGrowth(
    const GrowthOrder& order, std::shared_ptr<const HandModel> hand,
    const Decoder& decoder, const OpenService& open, ExecutionContext& context);

}  // namespace graspdb
