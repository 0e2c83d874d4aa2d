#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/execution_context.h"
#include "server/orders.h"
#include "server/store/store.h"

namespace graspdb {

/** How the example lies on the novel object N. */
struct ObjectAlignment {
  std::string example_id;
  RigidTransform X_NE;
  double scale{1.0};
  double similarity{0.0};
};

/** All that a transfer starts from. */
struct TransferPlan {
  StoredObject novel;
  std::vector<StoredPart> novel_parts;
  std::vector<StoredPart> example_parts;
  ObjectAlignment alignment;
  /** For each novel part what was learned for its label, if it is wanted. */
  std::vector<std::optional<StoredGraspSpace>> spaces;
  std::vector<std::string> labels;     ///< Of the category's parts.
  std::vector<std::string> wanted;     ///< Of them, what grasps are for …
  std::vector<std::string> keep_free;  ///< … and what the task keeps free.
  std::vector<std::string> warnings;
};

/** Which parts an order wants: by label, by task, or all of the category.
 @retval kNotFound naming the known parts or tasks. */
Result<std::vector<std::string>> FindWantedLabels(
    const TransferOrder& order, const StoredCategory& category);

/** The conflict that nothing is learned yet, with the command that learns.
 @param example_id  What could be learned; may be empty. */
Error MakeNotLearned(const std::string& category, const std::string& hand,
                     const std::string& example_id);

/** Finds the example, its parts and what was learned of them for a segmented
 object.
 @retval kNotInCategory when it is not like the category or has no wanted part.
 @retval kConflict when nothing is learned. */
Result<TransferPlan> MakeTransferPlan(const Store& store,
                                      const TransferOrder& order,
                                      const StoredObject& novel,
                                      ExecutionContext& context);

}  // namespace graspdb
