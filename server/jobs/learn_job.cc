#include <algorithm>
#include <chrono>
#include <set>

#include <fmt/format.h>

#include "server/codec/parameters_json.h"
#include "server/ids.h"
#include "server/jobs/service.h"
#include "server/jobs/sub_context.h"

namespace graspdb {
namespace {

// What is to be learned: a part with a hand each.
struct Lesson {
  size_t part;  ///< Its place among the object's.
  std::string hand;
};

constexpr size_t kMostHands = 64;

Result<std::vector<std::string>> ListHandNames(const Store& store) {
  GRASPDB_TRY(hands, store.ListHands({1000, ""}));
  std::vector<std::string> names;
  for (const StoredHand& hand : hands.items) names.push_back(hand.name);
  return names;
}

Result<std::vector<Lesson>> ListLessons(const Store& store,
                                        const LearnOrder& order,
                                        const std::vector<StoredPart>& parts) {
  GRASPDB_TRY(all_hands, ListHandNames(store));
  const auto& hands = order.hands.empty() ? all_hands : order.hands;
  std::vector<Lesson> lessons;
  for (const std::string& hand : hands) {
    for (size_t i = 0; i < parts.size(); ++i) {
      const auto& wanted = order.part_labels;
      if (wanted.empty() || std::find(wanted.begin(), wanted.end(),
                                      parts[i].label) != wanted.end()) {
        lessons.push_back({i, hand});
      }
    }
  }
  return lessons;
}

StoredGraspSpace DescribeLesson(const StoredPart& part, const std::string& hand,
                                const StoredObject& object,
                                const LearnOrder& order) {
  StoredGraspSpace record;
  record.object_id = object.id;
  record.part_id = part.id;
  record.part_label = part.label;
  record.category = object.category;
  record.hand = hand;
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
  const std::set<std::string> different(order.hands.begin(), order.hands.end());
  if (order.hands.size() > kMostHands ||
      different.size() != order.hands.size()) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("hands takes at most {}, each once.", kMostHands),
                 "", "hands"};
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
  GRASPDB_TRY(parts, store_->ListParts(object.id));
  GRASPDB_TRY(solids, store_->ReadSolids(parts));
  GRASPDB_TRY(lessons, ListLessons(*store_, order, parts));
  std::vector<StoredGraspSpace> spaces;
  const double count = static_cast<double>(lessons.size());
  for (size_t i = 0; i < lessons.size(); ++i) {
    const Lesson& lesson = lessons[i];
    const StoredPart& part = parts[lesson.part];
    StoredGraspSpace record = DescribeLesson(part, lesson.hand, object, order);
    GRASPDB_TRY(known,
                store_->FindLearned(record.part_id, record.hand,
                                    record.parameters_hash, record.seed));
    if (known) {
      spaces.push_back(*known);
      continue;
    }
    GRASPDB_TRY(hand, FindHandShape(lesson.hand, context));
    SubContext part_context(
        context, fmt::format("learn {} with {}", part.label, lesson.hand),
        static_cast<double>(i) / count, static_cast<double>(i + 1) / count);
    const auto start = ExecutionContext::Clock::now();
    LearnRequest request;
    request.hand = hand;
    request.part_E = solids[lesson.part];
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
