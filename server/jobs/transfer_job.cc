#include <algorithm>
#include <chrono>
#include <numeric>

#include <fmt/format.h>

#include "server/codec/parameters_json.h"
#include "server/ids.h"
#include "server/jobs/service.h"
#include "server/jobs/sub_context.h"
#include "server/jobs/transfer_plan.h"

namespace graspdb {
namespace {

constexpr double kImportShare = 0.15;  // Of a transfer's progress.

using Seconds = std::chrono::duration<double>;

double CalcSecondsSince(ExecutionContext::Clock::time_point start) {
  return Seconds(ExecutionContext::Clock::now() - start).count();
}

// The row of the transfer before it ran.
StoredTransfer DescribeTransferRow(const TransferOrder& order,
                                   const TransferPlan& plan,
                                   std::optional<int> enough) {
  StoredTransfer row;
  row.enough = enough;
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
  if (row.enough) content += fmt::format(" until {}", *row.enough);
  row.id = MakeContentId(content);
  return row;
}

Result<TransferRequest> MakeRequest(const Store& store,
                                    const TransferOrder& order,
                                    const TransferPlan& plan,
                                    std::shared_ptr<const HandShape> hand,
                                    std::shared_ptr<const Solid> whole_E,
                                    int threads) {
  TransferRequest request;
  request.hand = std::move(hand);
  GRASPDB_TRY(novel, store.ReadObjectMeshes(plan.novel.id));
  GRASPDB_TRY(example_parts, store.ReadSolids(plan.example_parts));
  GRASPDB_TRY(novel_parts, store.ReadSolids(plan.novel_parts));
  request.whole_E = std::move(whole_E);
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

// What both stages took of one core, by part.
void AddCoreSeconds(const std::vector<TransferRecord>& records,
                    const TransferPlan& plan,
                    std::vector<std::pair<std::string, double>>& seconds) {
  for (size_t p = 0; p < plan.novel_parts.size(); ++p) {
    if (!plan.spaces[p]) continue;
    double transfer = 0.0;
    double assembly = 0.0;
    for (const TransferRecord& record : records) {
      if (record.part != static_cast<int>(p)) continue;
      transfer += record.transfer_seconds;
      assembly += record.assembly_seconds;
    }
    const std::string& label = plan.novel_parts[p].label;
    seconds.emplace_back(MakeCoreStage("transfer", label), transfer);
    seconds.emplace_back(MakeCoreStage("assembly", label), assembly);
  }
}

// Turns the engine's records into rows.
class RowMaker {
 public:
  RowMaker(const TransferPlan& plan, const TransferRequest& request,
           StoredTransfer& transfer)
      : plan_(plan), request_(request), transfer_(transfer) {}

  // One that was cut before it found anything says nothing.
  void Add(const TransferRecord& record, int index) {
    const bool found = transfer_.stage == GraspStage::kAssembly
                           ? record.assembled.has_value()
                           : record.transferred.has_value();
    if (record.cut && !found) return;
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

  StoredGrasp MakeGrasp(const TransferRecord& record, const Grasp& grasp,
                        GraspStage stage, int index) const {
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
      row.robust = record.robust.stable;
      row.grip = record.robust.gripped;
      row.penetration = record.penetration;
    }
    row.grasp_space_id = plan_.spaces[part]->id;
    row.transfer_id = transfer_.id;
    row.source_grasp_id = MakeGraspId(row.grasp_space_id, GraspStage::kLearned,
                                      record.source_grasp);
    row.engine_version = transfer_.engine_version;
    row.parameters_hash = transfer_.parameters_hash;
    row.seed = transfer_.seed;
    return row;
  }

 private:
  std::string AddGrasp(const TransferRecord& record, const Grasp& grasp,
                       GraspStage stage, int index) {
    grasps_.push_back(MakeGrasp(record, grasp, stage, index));
    return grasps_.back().id;
  }

  const TransferPlan& plan_;
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
                                               ExecutionContext& context,
                                               const GraspCallback& on_grasp) {
  auto answer = FindOrMakeTransfer(order, context, on_grasp);
  if (!answer && answer.error().code == ErrorCode::kCancelled &&
      context.TimedOut()) {
    return MakeTimedOut();
  }
  return answer;
}

Result<TransferAnswer> Service::FindOrMakeTransfer(
    const TransferOrder& order, ExecutionContext& context,
    const GraspCallback& on_grasp) {
  const auto start = ExecutionContext::Clock::now();
  GRASPDB_TRY(checked, CheckTransfer(order));
  GRASPDB_TRY(novel, FindTransferObject(checked, context));
  GRASPDB_TRY(plan, MakeTransferPlan(*store_, checked, novel, context));
  // One that tried all sources answers any count.
  StoredTransfer row = DescribeTransferRow(checked, plan, std::nullopt);
  row.inputs_id = row.id;
  bool known = store_->FindTransfer(row.id).has_value();
  if (!known && order.count && !order.exhaustive) {
    const std::string inputs_id = row.id;
    row = DescribeTransferRow(checked, plan, order.count);
    row.inputs_id = inputs_id;
    known = store_->FindTransfer(row.id).has_value();
  }
  if (known) {
    context.ReportProgress("known", 1.0);
    return DescribeTransfer(row.id, order.count);
  }
  row.seconds.emplace_back("import", CalcSecondsSince(start));

  GRASPDB_TRY(hand, FindHandShape(order.hand, context));
  GRASPDB_TRY(whole_E, FindWholeSolid(plan.alignment.example_id));
  GRASPDB_TRY(request, MakeRequest(*store_, checked, plan, hand, whole_E,
                                   options_.threads));
  request.enough = row.enough;
  RowMaker rows(plan, request, row);
  if (on_grasp) {
    request.on_record = [&](int index, const TransferRecord& record) {
      const bool whole = row.stage == GraspStage::kAssembly;
      const auto& grasp = whole ? record.assembled : record.transferred;
      if (grasp) on_grasp(rows.MakeGrasp(record, *grasp, row.stage, index));
    };
  }
  const auto transfer_start = ExecutionContext::Clock::now();
  SubContext transferring(context, "transfer", kImportShare, 0.98);
  GRASPDB_TRY(result, Transfer(request, transferring.context()));
  row.seconds.emplace_back("transfer", CalcSecondsSince(transfer_start));

  if (!result.complete && !context.TimedOut()) {
    return Error{ErrorCode::kCancelled, "The transfer was cancelled.",
                 "send the request again"};
  }
  if (!result.complete) {
    const bool found =
        std::any_of(result.records.begin(), result.records.end(),
                    [](const TransferRecord& record) {
                      return record.transferred || record.assembled;
                    });
    if (!found) return MakeTimedOut();
    row.complete = false;
    row.id = MakeContentId("cut transfer " + MakeUuid());
    row.warnings.push_back(
        "the deadline ended the search: these are the grasps found until then");
  }
  rows.AddMaps(result.alignments);
  for (size_t i = 0; i < result.records.size(); ++i) {
    rows.Add(result.records[i], static_cast<int>(i));
  }
  AddCoreSeconds(result.records, plan, row.seconds);
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
  query.sort = GraspQuery::Sort::kMerit;
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
