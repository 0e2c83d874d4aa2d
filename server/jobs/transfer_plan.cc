#include "server/jobs/transfer_plan.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "server/jobs/segmentation.h"

namespace graspdb {
namespace {

constexpr uint64_t kAlignmentSeed = 1;

bool Contains(const std::vector<std::string>& list, const std::string& item) {
  return std::find(list.begin(), list.end(), item) != list.end();
}

// The stored alignment, or a new one when its example is gone or when the parts
// were labelled by hand.
Result<ObjectAlignment> FindAlignment(const Store& store,
                                      const StoredObject& object,
                                      const StoredCategory& category,
                                      ExecutionContext& context) {
  const StoredSegmentation& known = object.segmentation;
  if (!known.example_id.empty()) {
    return ObjectAlignment{known.example_id, known.X_NE, known.scale,
                           known.similarity};
  }
  GRASPDB_TRY(meshes, store.ReadObjectMeshes(object.id));
  GRASPDB_TRY(found, SegmentByExamples(store, category, category.segmentation,
                                       meshes, "", kAlignmentSeed, context));
  return ObjectAlignment{found.record.example_id, found.record.X_NE,
                         found.record.scale, found.record.similarity};
}

// What was learned last for one part of an example.
Result<std::optional<StoredGraspSpace>> FindNewestSpace(
    const Store& store, const std::string& example_id, const std::string& label,
    const std::string& hand) {
  std::optional<StoredGraspSpace> newest;
  PageRequest page{1000, ""};
  do {
    GRASPDB_TRY(spaces,
                store.ListGraspSpaces({"", label, hand, example_id}, page));
    if (!spaces.items.empty()) newest = spaces.items.back();
    page.cursor = spaces.next_cursor;
  } while (!page.cursor.empty());
  return newest;
}

}  // namespace

Error MakeNotLearned(const std::string& category, const std::string& hand,
                     const std::string& example_id) {
  return Error{ErrorCode::kConflict,
               "Nothing has been learned yet for category '" + category +
                   "' with hand '" + hand + "'.",
               example_id.empty()
                   ? "graspdb populate data, or POST /v1/categories/" +
                         category + "/examples"
                   : "graspdb learn " + example_id + " --hand " + hand +
                         ", or POST /v1/objects/" + example_id +
                         "/grasp-spaces",
               "category"};
}

Result<std::vector<std::string>> FindWantedLabels(
    const TransferOrder& order, const StoredCategory& category) {
  const std::vector<std::string> all = MakeVocabulary(category).labels;
  if (!order.task.empty()) {
    auto labels = FindPartsForTask(category, order.task);
    if (!labels.empty()) return labels;
    std::vector<std::string> tasks;
    for (const CategoryPart& part : category.parts) {
      for (const auto& [task, note] : part.tasks) {
        if (!Contains(tasks, task)) tasks.push_back(task);
      }
    }
    return Error{ErrorCode::kNotFound,
                 "No part of category '" + category.name + "' serves '" +
                     order.task + "'.",
                 fmt::format("known: {}", fmt::join(tasks, ", ")), "task"};
  }
  for (const std::string& label : order.part_labels) {
    if (Contains(all, label)) continue;
    return Error{
        ErrorCode::kNotFound,
        "Category '" + category.name + "' has no part '" + label + "'.",
        fmt::format("known: {}", fmt::join(all, ", ")), "part"};
  }
  return order.part_labels.empty() ? all : order.part_labels;
}

Result<TransferPlan> MakeTransferPlan(const Store& store,
                                      const TransferOrder& order,
                                      const StoredObject& novel,
                                      ExecutionContext& context) {
  TransferPlan plan;
  plan.novel = novel;
  plan.warnings = novel.segmentation.warnings;
  if (novel.cloud && novel.cloud->report.one_sided) {
    plan.warnings.push_back(fmt::format(
        "the cloud was seen from one side: {:.0f} % of the surface is made up",
        100.0 * (1.0 - novel.cloud->seen_share)));
  }
  GRASPDB_TRY(category, store.FindCategory(novel.category));
  if (novel.segmentation.verdict == ToString(SegmentationVerdict::kForeign)) {
    return Error{ErrorCode::kNotInCategory,
                 fmt::format("The object does not look like a {} (similarity "
                             "{:.2f}).",
                             category.name, novel.segmentation.similarity),
                 "POST /v1/objects/" + novel.id +
                     "/segmentation with face labels, or name another category",
                 "category"};
  }
  GRASPDB_TRY(alignment, FindAlignment(store, novel, category, context));
  plan.alignment = alignment;
  GRASPDB_TRY(novel_parts, store.ListParts(novel.id));
  GRASPDB_TRY(example_parts, store.ListParts(alignment.example_id));
  plan.novel_parts = std::move(novel_parts);
  plan.example_parts = std::move(example_parts);
  plan.labels = MakeVocabulary(category).labels;
  plan.keep_free = FindPartsKeptFree(category, order.task);
  GRASPDB_TRY(wanted, FindWantedLabels(order, category));
  plan.wanted = wanted;
  int found = 0;
  for (const StoredPart& part : plan.novel_parts) {
    plan.spaces.emplace_back();
    if (!Contains(wanted, part.label)) continue;
    ++found;
    GRASPDB_TRY(space, FindNewestSpace(store, alignment.example_id, part.label,
                                       order.hand));
    if (!space) {
      plan.warnings.push_back("nothing is learned for the " + part.label);
    }
    plan.spaces.back() = space;
  }
  if (found == 0) {
    return Error{ErrorCode::kNotInCategory,
                 fmt::format("The object has no {}.", fmt::join(wanted, ", ")),
                 "GET /v1/objects/" + novel.id + "/parts lists its parts",
                 "part"};
  }
  if (std::none_of(plan.spaces.begin(), plan.spaces.end(),
                   [](const auto& space) { return space.has_value(); })) {
    return MakeNotLearned(category.name, order.hand, alignment.example_id);
  }
  for (const std::string& label : wanted) {
    if (std::none_of(
            plan.novel_parts.begin(), plan.novel_parts.end(),
            [&](const StoredPart& part) { return part.label == label; })) {
      plan.warnings.push_back("the object has no " + label);
    }
  }
  return plan;
}

}  // namespace graspdb
