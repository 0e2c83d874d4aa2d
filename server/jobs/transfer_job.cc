#include <algorithm>
#include <chrono>
#include <numeric>

#include <fmt/format.h>

#include "server/codec/parameters_json.h"
#include "server/ids.h"
#include "server/jobs/segmentation.h"
#include "server/jobs/service.h"
#include "server/jobs/sub_context.h"

namespace graspdb {
namespace {

constexpr uint64_t kAlignmentSeed = 1;
constexpr double kImportShare = 0.15;  // Of a transfer's progress.

using Seconds = std::chrono::duration<double>;

double CalcSecondsSince(ExecutionContext::Clock::time_point start) {
  return Seconds(ExecutionContext::Clock::now() - start).count();
}

bool Contains(const std::vector<std::string>& list, const std::string& item) {
  return std::find(list.begin(), list.end(), item) != list.end();
}

// How the example lies on the novel object.
struct Alignment {
  std::string example_id;
  RigidTransform X_NE;
  double scale{1.0};
  double similarity{0.0};
};

// All that a transfer starts from.
struct Plan {
  StoredObject novel;
  std::vector<StoredPart> novel_parts;
  std::vector<StoredPart> example_parts;
  Alignment alignment;
  /** For each novel part what was learned for its label, if it is wanted. */
  std::vector<std::optional<StoredGraspSpace>> spaces;
  std::vector<std::string> labels;     ///< Of the category's parts.
  std::vector<std::string> wanted;     ///< Of them, what grasps are for …
  std::vector<std::string> keep_free;  ///< … and what the task keeps free.
  std::vector<std::string> warnings;
};

// The stored alignment, or a new one when its example is gone or when the parts
// were labelled by hand.
Result<Alignment> FindAlignment(const Store& store, const StoredObject& object,
                                const StoredCategory& category,
                                ExecutionContext& context) {
  const StoredSegmentation& known = object.segmentation;
  if (!known.example_id.empty()) {
    return Alignment{known.example_id, known.X_NE, known.scale,
                     known.similarity};
  }
  GRASPDB_TRY(meshes, store.ReadObjectMeshes(object.id));
  GRASPDB_TRY(found, SegmentByExamples(store, category, category.segmentation,
                                       meshes, "", kAlignmentSeed, context));
  return Alignment{found.record.example_id, found.record.X_NE,
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

// Which parts are wanted: by label, by task, or all.
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

Result<Plan> MakePlan(const Store& store, const TransferOrder& order,
                      const StoredObject& novel, ExecutionContext& context) {
  Plan plan;
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

// The row of the transfer before it ran.
StoredTransfer DescribeTransferRow(const TransferOrder& order,
                                   const Plan& plan) {
  StoredTransfer row;
  row.object_id = plan.novel.id;
  row.example_id = plan.alignment.example_id;
  row.category = plan.novel.category;
  row.hand = order.hand;
  row.stage = order.stage;
  row.sources_per_part = order.sources;
  row.parameters = ParametersToJson(order.parameters);
  row.parameters_hash = MakeContentId(row.parameters);
  row.seed = order.seed;
  row.engine_version = EngineVersion();
  row.similarity = plan.alignment.similarity;
  row.warnings = plan.warnings;
  row.keep_free = plan.keep_free;
  std::string content = fmt::format(
      "transfer {} {} {} {} {}", row.engine_version, ToString(row.stage),
      row.sources_per_part, row.parameters_hash, row.seed);
  for (size_t i = 0; i < plan.novel_parts.size(); ++i) {
    content += " " + plan.novel_parts[i].id;
    if (!plan.spaces[i]) continue;
    content += " from " + plan.spaces[i]->id;
    row.part_labels.push_back(plan.novel_parts[i].label);
  }
  for (const std::string& label : plan.wanted) content += " wants " + label;
  for (const std::string& label : row.keep_free) content += " frees " + label;
  row.id = MakeContentId(content);
  return row;
}

LabelledMesh TakeWorkMesh(ObjectMeshes& meshes) {
  return LabelledMesh{std::move(meshes.work), std::move(meshes.work_labels)};
}

Result<TransferRequest> MakeRequest(const Store& store,
                                    const TransferOrder& order,
                                    const Plan& plan,
                                    std::shared_ptr<const HandModel> hand,
                                    int threads) {
  TransferRequest request;
  request.hand = std::move(hand);
  GRASPDB_TRY(example, store.ReadObjectMeshes(plan.alignment.example_id));
  GRASPDB_TRY(novel, store.ReadObjectMeshes(plan.novel.id));
  GRASPDB_TRY(example_parts, store.ReadSolids(plan.alignment.example_id));
  GRASPDB_TRY(novel_parts, store.ReadSolids(plan.novel.id));
  request.example = TakeWorkMesh(example);
  // The parts are of the working mesh, what is checked last is the object.
  request.novel = {std::move(novel.canonical),
                   std::move(novel.canonical_labels)};
  if (plan.novel.cloud) {
    request.seen_N = std::make_shared<const SeenSurface>(
        novel.cloud, CalcSeenReach(plan.novel.cloud->report));
  }
  request.example_parts = std::move(example_parts);
  request.novel_parts = std::move(novel_parts);
  request.X_NE = plan.alignment.X_NE;
  request.scale = plan.alignment.scale;
  for (const auto& record : plan.spaces) {
    request.grasp_spaces.emplace_back();
    if (!record) continue;
    GRASPDB_TRY(space, store.ReadGraspSpace(record->id));
    request.grasp_spaces.back() =
        std::make_shared<const GraspSpace>(std::move(space));
  }
  for (const std::string& label : plan.keep_free) {
    request.keep_free.push_back(static_cast<int>(
        std::find(plan.labels.begin(), plan.labels.end(), label) -
        plan.labels.begin()));
  }
  request.sources_per_part = order.sources;
  request.assemble = order.stage == GraspStage::kAssembly;
  request.parameters = order.parameters;
  request.seed = order.seed;
  request.threads = threads;
  return request;
}

// For each contact the image of the source's nearest contact by the same link.
std::vector<std::optional<Eigen::Vector3d>> MatchTargets(
    const Grasp& grasp, const Grasp& source,
    const std::vector<std::optional<Eigen::Vector3d>>& targets) {
  std::vector<std::optional<Eigen::Vector3d>> matched;
  for (const Contact& contact : grasp.contacts) {
    std::optional<Eigen::Vector3d> nearest;
    for (size_t i = 0; i < targets.size() && i < source.contacts.size(); ++i) {
      if (!targets[i] || source.contacts[i].link != contact.link) continue;
      if (!nearest || (*targets[i] - contact.p_O).norm() <
                          (*nearest - contact.p_O).norm()) {
        nearest = targets[i];
      }
    }
    matched.push_back(nearest);
  }
  return matched;
}

// Turns the engine's records into rows.
class RowMaker {
 public:
  RowMaker(const Plan& plan, const TransferRequest& request,
           StoredTransfer& transfer)
      : plan_(plan), request_(request), transfer_(transfer) {}

  void Add(const TransferRecord& record, int index) {
    const auto part = static_cast<size_t>(record.part);
    const StoredGraspSpace& space = *plan_.spaces[part];
    StoredAttempt attempt;
    attempt.source_grasp_id =
        MakeGraspId(space.id, GraspStage::kLearned, record.source_grasp);
    attempt.part_id = plan_.novel_parts[part].id;
    attempt.part_label = plan_.novel_parts[part].label;
    attempt.transfer = record.transfer;
    attempt.assembly = record.assembly;
    attempt.example_epsilon = record.example_epsilon;
    attempt.example_epsilon_whole = record.example_epsilon_whole;
    attempt.open_close_epsilon_part = record.open_close_epsilon_part;
    attempt.open_close_epsilon_whole = record.open_close_epsilon_whole;
    if (record.transferred) {
      attempt.transferred_grasp_id =
          AddGrasp(record, *record.transferred, GraspStage::kTransfer, index);
    }
    if (record.assembled) {
      attempt.assembled_grasp_id =
          AddGrasp(record, *record.assembled, GraspStage::kAssembly, index);
    }
    transfer_.attempts.push_back(std::move(attempt));
  }

  void AddMaps(const std::vector<PartAlignment>& alignments) {
    for (size_t i = 0; i < plan_.novel_parts.size(); ++i) {
      if (!plan_.spaces[i]) continue;
      const StoredPart& part = plan_.novel_parts[i];
      StoredContactMap map;
      map.transfer_id = transfer_.id;
      map.id = MakeContentId("contact map " + transfer_.id + " " + part.id);
      map.example_part_id = plan_.spaces[i]->part_id;
      map.novel_part_id = part.id;
      map.part_label = part.label;
      map.alignment = alignments[i];
      transfer_.contact_maps.push_back(std::move(map));
    }
  }

  const std::vector<StoredGrasp>& grasps() const { return grasps_; }

 private:
  std::string AddGrasp(const TransferRecord& record, const Grasp& grasp,
                       GraspStage stage, int index) {
    const auto part = static_cast<size_t>(record.part);
    const bool whole = stage == GraspStage::kAssembly;
    const Grasp& source =
        request_.grasp_spaces[part]
            ->grasps[static_cast<size_t>(record.source_grasp)];
    StoredGrasp row;
    row.id = MakeGraspId(transfer_.id, stage, index);
    row.stage = stage;
    row.index = index;
    row.object_id = plan_.novel.id;
    row.part_id = plan_.novel_parts[part].id;
    row.part_label = plan_.novel_parts[part].label;
    row.category = transfer_.category;
    row.hand = transfer_.hand;
    row.grasp = grasp;
    row.clearances = NameClearances(
        whole ? record.assembled_clearances : record.transferred_clearances,
        plan_.labels, row.part_label);
    row.targets_O = MatchTargets(grasp, source, record.targets_N);
    row.example_epsilon =
        whole ? record.example_epsilon_whole : record.example_epsilon;
    row.open_close_epsilon = whole ? record.open_close_epsilon_whole
                                   : record.open_close_epsilon_part;
    // The record judges the last stage that was reached.
    if (whole || !record.assembled) {
      row.robust = record.robust;
      row.penetration = record.penetration;
    }
    row.grasp_space_id = plan_.spaces[part]->id;
    row.transfer_id = transfer_.id;
    row.source_grasp_id = MakeGraspId(row.grasp_space_id, GraspStage::kLearned,
                                      record.source_grasp);
    grasps_.push_back(std::move(row));
    return grasps_.back().id;
  }

  const Plan& plan_;
  const TransferRequest& request_;
  StoredTransfer& transfer_;
  std::vector<StoredGrasp> grasps_;
};

}  // namespace

Result<TransferOrder> Service::CheckTransfer(const TransferOrder& order) const {
  TransferOrder checked = order;
  const auto invalid = [](const char* field, const std::string& message) {
    return Error{ErrorCode::kInvalidArgument, message, "", field};
  };
  if (order.sources < 1 || order.sources > 1000) {
    return invalid("sources", "sources must lie in 1..1000.");
  }
  if (order.count && (*order.count < 1 || *order.count > 1000)) {
    return invalid("count", "count must lie in 1..1000.");
  }
  if (order.stage == GraspStage::kLearned) {
    return invalid("stage", "stage must be transfer or assembly.");
  }
  if (!order.task.empty() && !order.part_labels.empty()) {
    return invalid("task", "Give parts or a task, not both.");
  }
  GRASPDB_TRY_VOID(ValidateParameters(order.parameters));
  if (const auto hand = FindHandModel(order.hand); !hand) return hand.error();
  std::string category = order.category;
  if (order.object_id.empty()) {
    if (order.category.empty()) {
      return invalid("category", "A category is needed, or auto.");
    }
    checked.mesh.role = ObjectRole::kNovel;
    checked.mesh.category = order.category;
    GRASPDB_TRY(mesh, CheckImport(checked.mesh));
    checked.mesh = std::move(mesh);
  } else {
    GRASPDB_TRY(object, store_->FindObject(order.object_id));
    if (!object.category.empty()) category = object.category;
    if (!order.category.empty() && order.category != "auto" &&
        order.category != category) {
      return Error{
          ErrorCode::kConflict,
          "Object " + object.id + " is of category '" + object.category + "'.",
          "POST /v1/objects/" + object.id +
              "/segmentation with another category",
          "category"};
    }
    if (category.empty()) {
      return invalid("category", "The object is of no category: name one.");
    }
  }
  if (category == "auto") return checked;
  GRASPDB_TRY(known, store_->FindCategory(category));
  if (const auto wanted = FindWantedLabels(order, known); !wanted) {
    return wanted.error();
  }
  GRASPDB_TRY(learned,
              store_->ListGraspSpaces({category, "", order.hand, ""}, {1, ""}));
  if (!learned.items.empty()) return checked;
  GRASPDB_TRY(examples,
              store_->ListObjects({category, ObjectRole::kExample}, {1, ""}));
  return MakeNotLearned(category, order.hand,
                        examples.items.empty() ? "" : examples.items[0].id);
}

Result<StoredObject> Service::FindTransferObject(const TransferOrder& order,
                                                 ExecutionContext& context) {
  SubContext importing(context, "import", 0.0, kImportShare);
  if (order.object_id.empty()) {
    GRASPDB_TRY(imported, ImportObject(order.mesh, importing.context()));
    return imported.object;
  }
  GRASPDB_TRY(object, store_->FindObject(order.object_id));
  if (!object.segmentation.method.empty()) return object;
  SegmentOrder segment;
  segment.object_id = object.id;
  segment.category = order.category;
  GRASPDB_TRY(segmented, Resegment(segment, importing.context()));
  return segmented.object;
}

Result<TransferAnswer> Service::TransferGrasps(const TransferOrder& order,
                                               ExecutionContext& context) {
  const auto start = ExecutionContext::Clock::now();
  GRASPDB_TRY(checked, CheckTransfer(order));
  GRASPDB_TRY(novel, FindTransferObject(checked, context));
  GRASPDB_TRY(plan, MakePlan(*store_, checked, novel, context));
  StoredTransfer row = DescribeTransferRow(checked, plan);
  if (const auto known = store_->FindTransfer(row.id); known) {
    context.ReportProgress("known", 1.0);
    return DescribeTransfer(row.id, order.count);
  }
  row.seconds.emplace_back("import", CalcSecondsSince(start));

  GRASPDB_TRY(hand, FindHandModel(order.hand));
  GRASPDB_TRY(request,
              MakeRequest(*store_, checked, plan, hand, options_.threads));
  const auto transfer_start = ExecutionContext::Clock::now();
  SubContext transferring(context, "transfer", kImportShare, 0.98);
  GRASPDB_TRY(result, Transfer(request, transferring.context()));
  row.seconds.emplace_back("transfer", CalcSecondsSince(transfer_start));

  row.complete = result.complete;
  RowMaker rows(plan, request, row);
  rows.AddMaps(result.alignments);
  for (size_t i = 0; i < result.records.size(); ++i) {
    rows.Add(result.records[i], static_cast<int>(i));
  }
  context.ReportProgress("store", 0.98);
  GRASPDB_TRY(stored, store_->InsertTransfer(row, rows.grasps()));
  context.ReportProgress("done", 1.0);
  return DescribeTransfer(stored.id, order.count);
}

Result<TransferAnswer> Service::DescribeTransfer(
    const std::string& transfer_id, std::optional<int> count) const {
  TransferAnswer answer;
  GRASPDB_TRY(transfer, store_->FindTransfer(transfer_id));
  GRASPDB_TRY(object, store_->FindObject(transfer.object_id));
  GRASPDB_TRY(parts, store_->ListParts(transfer.object_id));
  GRASPDB_TRY(hand, FindHandModel(transfer.hand));
  GraspQuery query;
  query.transfer_id = transfer_id;
  query.stage = transfer.stage;
  do {
    const int64_t missing =
        count ? *count - std::ssize(answer.grasps) : int64_t{1000};
    query.page.limit = static_cast<int>(std::min<int64_t>(missing, 1000));
    GRASPDB_TRY(page, store_->QueryGrasps(query));
    std::move(page.items.begin(), page.items.end(),
              std::back_inserter(answer.grasps));
    query.page.cursor = page.next_cursor;
  } while (!query.page.cursor.empty() &&
           (!count || std::ssize(answer.grasps) < *count));
  answer.transfer = std::move(transfer);
  answer.object = std::move(object);
  answer.parts = std::move(parts);
  answer.hand = std::move(hand);
  return answer;
}

}  // namespace graspdb
