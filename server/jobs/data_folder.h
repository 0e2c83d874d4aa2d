#pragma once

#include <string>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "server/jobs/service.h"

namespace graspdb {

struct PopulateOrder {
  std::string
      folder;  ///< With hands/<name>/hand.json, <category>/category.json.
  std::vector<std::string> categories;  ///< Folders' names; empty: all.
  std::vector<std::string> hands;       ///< To learn with; empty: all.
  Parameters parameters;
  uint64_t seed{1};
  bool learn{true};
};

/** Brings a data folder into the database: hands, categories, examples, and
 what is learned from them. What is known is left as it is, so that it can be
 run again at any time. Novel objects of the folder are for users to POST.
 @returns all grasp spaces of the folder's examples.
 @retval kInvalidArgument naming the file at fault. */
Result<std::vector<StoredGraspSpace>> Populate(Service& service,
                                               const PopulateOrder& order,
                                               ExecutionContext& context);

}  // namespace graspdb
