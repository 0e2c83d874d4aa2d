#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "server/codec/json.h"
#include "server/jobs/service.h"

namespace graspdb {

/** Parameters under a name. */
struct BenchVariant {
  std::string name;
  Parameters parameters;
};

struct PaperBenchOrder {
  std::string data{"data"};  ///< A data folder, see data_folder.h.
  std::string out{"bench"};  ///< Databases, rows and reports go here.
  std::string objects;       ///< Other people's meshes: <category>/<mesh>.
  std::string units{"m"};    ///< Of those whose format does not tell.
  std::vector<std::string> categories{"mug", "spray_bottle", "power_drill"};
  std::vector<BenchVariant> variants;   ///< Side by side.
  std::vector<BenchVariant> ablations;  ///< Judged by six pushes only.
  bool quick{false};    ///< One novel object a category, few grasps.
  bool physical{true};  ///< Whether a simulator judges.
  /** For each way to seed the swarm and each part; 0: not compared. Unset: 10,
   or 0 when quick. */
  std::optional<double> seeding_seconds;
  int sources{40};  ///< Per part.
  uint64_t seed{1};
};

/** Opens a database file, new or not. */
using OpenService =
    std::function<Result<std::unique_ptr<Service>>(const std::string& db)>;

/** The database in `out` for all that is learned with these parameters. A
 transfer takes the grasp space that was learned last: a file for each way to
 learn, so that no bench takes another's. */
std::string MakeLearningPath(const std::string& out,
                             const Parameters& parameters);

/** Learns the examples, transfers to every novel object, assembles, compares
 and lets a simulator judge: all tables and figures of the paper, and more. What
 was done before with the same order is read from `out`, so that it may be
 interrupted at any time. Deterministic but for what is named "seconds",
 "machine" and "seeding", which time ends. Writes out/paper.json and
 out/paper.html.
 @returns the JSON.
 @retval kInvalidArgument naming the file at fault; kCancelled. */
Result<Json> RunPaperBench(const PaperBenchOrder& order,
                           const OpenService& open, ExecutionContext& context);

/** Each of what the default adds to the paper, left out: for the ablation
 table. */
std::vector<BenchVariant> MakeAblations();

}  // namespace graspdb
