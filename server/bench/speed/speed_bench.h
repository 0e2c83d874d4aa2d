#pragma once

#include <string>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "server/bench/paper_bench.h"
#include "server/codec/json.h"
#include "server/decode/decode_client.h"

namespace graspdb {

struct SpeedBenchOrder {
  std::string data{"data"};  ///< A data folder, see data_folder.h.
  std::string out{"bench"};  ///< Databases and reports go here.
  std::string category{"mug"};
  Parameters parameters;  ///< Of learning.
  DecoderOptions decoder;
  std::vector<std::string> server_options;  ///< Of the servers it starts.
  bool quick{false};                        ///< Few repetitions, small sizes.
  uint64_t seed{1};
};

/** How long everything takes: each hot function beside the library call that
 does the same, each stage of a transfer, whole requests over HTTP to servers of
 its own, and how cost grows. Learns the category's example unless the paper's
 bench or an earlier one has done so in `out`. Writes out/speed.json,
 out/speed.txt and out/growth-*.svg.
 @returns the JSON.
 @retval kInvalidArgument naming the file at fault; kCancelled. */
Result<Json> RunSpeedBench(const SpeedBenchOrder& order,
                           const OpenService& open, ExecutionContext& context);

/** What RunSpeedBench() found, as tables for a terminal. */
std::string MakeSpeedReport(const Json& report);

}  // namespace graspdb
