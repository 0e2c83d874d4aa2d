#pragma once

#include <string>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "server/bench/speed/speed_rows.h"

namespace graspdb {

/** Whole requests over HTTP. */
struct RequestOrder {
  std::string db;  ///< With a learned category; not served by anyone.
  std::vector<std::string> server_options;
  std::string category{"mug"};
  std::vector<std::string> meshes;  ///< OBJ files, coarse to fine.
  std::string largest;  ///< One as large as is taken; empty: not measured.
  int repetitions{3};
  int sources{40};  ///< Of each part, where all are tried.
  double query_seconds{2.0};
};

/** Queries of stored grasps by category as fast as they are answered. */
struct QueryLoad {
  double p50{0.0};  ///< s.
  double p99{0.0};  ///< s.
  double per_second{0.0};
};

/** Asks for the best twenty grasps of a category on so many connections.
 @retval kInternal when the server fails. */
Result<QueryLoad> MeasureQueries(int port, const std::string& category,
                                 int connections, double seconds);

/** Uploads with bytes never seen before, on a server that has just started and
 on one that is warm; queries; the start itself and memory.
 @returns {"rows", "queries", "start_seconds", "peak_bytes"}.
 @retval kInternal when the server fails; kCancelled. */
Result<Json> MeasureRequests(const RequestOrder& order,
                             ExecutionContext& context);

}  // namespace graspdb
