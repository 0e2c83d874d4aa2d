#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "server/codec/parameters_json.h"
#include "server/ids.h"
#include "server/jobs/service.h"
#include "server/jobs/sub_context.h"

namespace graspdb {
namespace {

// One grasp space to be learned.
struct Lesson {
  StoredPart part;
  Part solid;
  std::string hand;
};

Result<std::vector<std::string>> ListHandNames(const Store& store) {
  GRASPDB_TRY(hands, store.ListHands({1000, ""}));
  std::vector<std::string> names;
  for (const StoredHand& hand : hands.items) names.push_back(hand.name);
  return names;
}

Result<std::vector<Lesson>> ListLessons(const Store& store,
                                        const LearnOrder& order) {
  GRASPDB_TRY(parts, store.ListParts(order.object_id));
  GRASPDB_TRY(solids, store.ReadSolids(order.object_id));
  GRASPDB_TRY(all_hands, ListHandNames(store));
  const auto& hands = order.hands.empty() ? all_hands : order.hands;
  std::vector<Lesson> lessons;
  for (const std::string& hand : hands) {
    for (size_t i = 0; i < parts.size(); ++i) {
      const auto& wanted = order.part_labels;
      if (wanted.empty() || std::find(wanted.begin(), wanted.end(),
                                      parts[i].label) != wanted.end()) {
        lessons.push_back({parts[i], solids[i], hand});
      }
    }
  }
  return lessons;
}

StoredGraspSpace DescribeLesson(const Lesson& lesson,
                                const StoredObject& object,
                                const LearnOrder& order) {
  StoredGraspSpace record;
  record.object_id = object.id;
  record.part_id = lesson.part.id;
  record.part_label = lesson.part.label;
  record.category = object.category;
  record.hand = lesson.hand;
  record.parameters = ParametersToJson(SelectForLearning(order.parameters));
  record.parameters_hash = MakeContentId(record.parameters);
  record.seed = order.seed;
  record.engine_version = EngineVersion();
  return record;
}

}  // namespace

Result<void> Service::CheckLearn(const LearnOrder& order) const {
  GRASPDB_TRY_VOID(ValidateParameters(order.parameters));
  GRASPDB_TRY(parts, store_->ListParts(order.object_id));
  if (parts.empty()) {
    return Error{ErrorCode::kConflict,
                 "Object " + order.object_id + " has no parts to learn.",
                 "POST /v1/objects/" + order.object_id +
                     "/segmentation with its category",
                 "object"};
  }
  for (const std::string& label : order.part_labels) {
    const bool known =
        std::any_of(parts.begin(), parts.end(),
                    [&](const StoredPart& p) { return p.label == label; });
    if (known) continue;
    std::vector<std::string> labels;
    for (const StoredPart& part : parts) labels.push_back(part.label);
    return Error{ErrorCode::kNotFound,
                 "The object has no part '" + label + "'.",
                 fmt::format("known: {}", fmt::join(labels, ", ")), "parts"};
  }
  for (const std::string& hand : order.hands) {
    if (const auto model = FindHandModel(hand); !model) return model.error();
  }
  GRASPDB_TRY(hands, ListHandNames(*store_));
  if (hands.empty()) {
    return Error{ErrorCode::kConflict, "There is no hand to learn with.",
                 "graspdb populate data, or POST /v1/hands", "hands"};
  }
  return {};
}

Result<std::vector<StoredGraspSpace>> Service::LearnObject(
    const LearnOrder& order, ExecutionContext& context) {
  GRASPDB_TRY_VOID(CheckLearn(order));
  GRASPDB_TRY(object, store_->FindObject(order.object_id));
  GRASPDB_TRY(meshes, store_->ReadObjectMeshes(object.id));
  GRASPDB_TRY(lessons, ListLessons(*store_, order));
  std::vector<StoredGraspSpace> spaces;
  const double count = static_cast<double>(lessons.size());
  for (size_t i = 0; i < lessons.size(); ++i) {
    const Lesson& lesson = lessons[i];
    StoredGraspSpace record = DescribeLesson(lesson, object, order);
    GRASPDB_TRY(known,
                store_->FindLearned(record.part_id, record.hand,
                                    record.parameters_hash, record.seed));
    if (known) {
      spaces.push_back(*known);
      continue;
    }
    GRASPDB_TRY(hand, FindHandShape(lesson.hand));
    SubContext part_context(
        context,
        fmt::format("learn {} with {}", lesson.part.label, lesson.hand),
        static_cast<double>(i) / count, static_cast<double>(i + 1) / count);
    const auto start = ExecutionContext::Clock::now();
    LearnRequest request;
    request.hand = hand;
    request.part_E = lesson.solid;
    request.whole_E = {meshes.work, meshes.work_labels};
    request.parameters = SelectForLearning(order.parameters);
    request.seed = order.seed;
    request.threads = options_.threads;
    GRASPDB_TRY(space, Learn(request, part_context.context()));
    record.seconds =
        std::chrono::duration<double>(ExecutionContext::Clock::now() - start)
            .count();
    record.configuration_space_seconds = space.configuration_space_seconds;
    GRASPDB_TRY(stored, store_->InsertGraspSpace(record, space));
    spaces.push_back(stored);
  }
  context.ReportProgress("learned", 1.0);
  return spaces;
}

}  // namespace graspdb
