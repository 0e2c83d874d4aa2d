#include "server/jobs/service.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "engine/admission/mesh_format.h"
#include "engine/hand/hand_maker.h"
#include "server/codec/input_json.h"
#include "server/codec/json.h"
#include "server/codec/order_json.h"
#include "server/decode/decode_client.h"
#include "server/files.h"
#include "server/ids.h"
#include "server/jobs/job_runner.h"
#include "server/jobs/segmentation.h"

namespace graspdb {
namespace {

// About what a hand takes: so many bytes for each of its triangles.
int64_t CalcHandBytes(const HandModel& hand, int64_t bytes_per_triangle) {
  int64_t triangles = 0;
  for (const HandLink& link : hand.links()) {
    for (const TriangleMesh& piece : link.pieces_L) {
      triangles += piece.num_triangles();
    }
  }
  return (64 << 10) + bytes_per_triangle * triangles;
}

// Names that users choose become parts of paths: [a-z0-9][a-z0-9_-]{0,63}.
Result<void> CheckName(const std::string& name, const std::string& field) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
  };
  const bool sound = !name.empty() && name.size() <= 64 && is_plain(name[0]) &&
                     std::all_of(name.begin(), name.end(), [&](char c) {
                       return is_plain(c) || c == '_' || c == '-';
                     });
  if (sound) return {};
  return Error{ErrorCode::kInvalidArgument,
               field +
                   " must be 1 to 64 of a-z, 0-9, _ and -, beginning with "
                   "a letter or digit.",
               "", field};
}

Result<void> CheckText(const std::string& text, size_t most,
                       const std::string& field) {
  if (text.size() <= most) return {};
  return Error{ErrorCode::kInvalidArgument,
               fmt::format("{} takes at most {} bytes.", field, most), "",
               field};
}

Result<void> CheckNotes(const std::map<std::string, std::string>& notes,
                        const std::string& field) {
  for (const auto& [task, note] : notes) {
    GRASPDB_TRY_VOID(CheckText(task, 64, field));
    GRASPDB_TRY_VOID(CheckText(note, 1000, field));
  }
  return {};
}

Result<void> CheckCategory(const StoredCategory& category) {
  GRASPDB_TRY_VOID(CheckName(category.name, "name"));
  if (category.name == "auto") {
    return Error{ErrorCode::kInvalidArgument,
                 "auto stands for any category and cannot be a name.", "",
                 "name"};
  }
  if (category.parts.empty() || category.parts.size() > kMostParts) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("A category has 1 to {} parts.", kMostParts), "",
                 "parts"};
  }
  GRASPDB_TRY_VOID(CheckText(category.title, 200, "title"));
  std::set<std::string> labels;
  for (const CategoryPart& part : category.parts) {
    GRASPDB_TRY_VOID(CheckName(part.label, "label"));
    if (!labels.insert(part.label).second) {
      return Error{ErrorCode::kInvalidArgument,
                   "The label '" + part.label + "' is there twice.", "",
                   "parts"};
    }
    GRASPDB_TRY_VOID(CheckNotes(part.tasks, "tasks"));
    GRASPDB_TRY_VOID(CheckNotes(part.keep_free, "keep_free"));
  }
  const auto num_parts = static_cast<int>(category.parts.size());
  for (const auto& [a, b] : category.adjacency) {
    GRASPDB_EXPECTS(a >= 0 && a < num_parts && b >= 0 && b < num_parts);
  }
  Parameters parameters;
  parameters.segmentation = category.segmentation;
  return ValidateParameters(parameters);
}

std::string CalcHandSha256(const HandFiles& files) {
  std::string content = CalcSha256(files.annotations) + CalcSha256(files.urdf);
  for (const auto& [name, bytes] : files.meshes) {
    content += CalcSha256(name) + CalcSha256(bytes);
  }
  return CalcSha256(content);
}

Result<std::shared_ptr<const HandModel>> BuildHand(
    const StoredHand& hand, const Decoder& decoder,
    const ExecutionContext& context) {
  GRASPDB_TRY(file, HandFileFromJson(hand.annotations));
  GRASPDB_TRY(tree, decoder.DecodeUrdf(hand.urdf, context));
  const auto load = [&](const std::string& name) -> Result<TriangleMesh> {
    for (const auto& [known, mesh] : hand.meshes) {
      if (CutFolders(known) == CutFolders(name)) return mesh;
    }
    return Error{ErrorCode::kUnusableInput,
                 "The URDF refers to " + name + ", which is not there.",
                 "send every mesh that it refers to", "mesh"};
  };
  GRASPDB_TRY(model, MakeHand(tree, file.annotations, load));
  return std::make_shared<const HandModel>(std::move(model));
}

Result<void> CheckHandMeshes(const HandFiles& files) {
  std::set<std::string_view> names;
  for (const auto& [name, bytes] : files.meshes) {
    const std::string_view file = CutFolders(name);
    const bool legible =
        !file.empty() && file.size() <= 100 && file.front() != '.' &&
        std::all_of(file.begin(), file.end(), [](unsigned char c) {
          return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
        });
    if (!legible) {
      return Error{
          ErrorCode::kInvalidArgument,
          "A mesh's file name has 1 to 100 letters, digits, _, - or ., "
          "as in the URDF.",
          "curl -F 'mesh=@palm.stl' sends the name, too", "mesh"};
    }
    if (!names.insert(file).second) {
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("Two meshes are called {}.", file),
                   "folders do not tell them apart", "mesh"};
    }
  }
  return {};
}

}  // namespace

Service::Service(std::unique_ptr<Store> store, std::unique_ptr<Decoder> decoder,
                 const ServiceOptions& options)
    : store_(std::move(store)),
      decoder_(std::move(decoder)),
      backups_(store_->path() + ".backups", options.max_backups),
      options_(options),
      runner_(std::make_unique<JobRunner>(*this)) {
  GRASPDB_EXPECTS(store_ != nullptr && decoder_ != nullptr);
}

Service::~Service() = default;

Result<std::string> Service::CheckDecoder() const { return decoder_->Check(); }

DecodeCounts Service::CountDecoded() const { return decoder_->counts(); }

std::map<std::string, CacheCounts> Service::CountCaches() const {
  return {{"hands", hands_.counts()},
          {"hand_shapes", hand_shapes_.counts()},
          {"whole_solids", whole_solids_.counts()},
          {"descriptors", descriptors_.counts()}};
}

Result<AddedCategory> Service::AddCategory(const StoredCategory& category) {
  GRASPDB_TRY_VOID(CheckCategory(category));
  return store_->InsertCategory(category);
}

Result<StoredCategory> Service::UpdateCategory(const std::string& name,
                                               const CategoryChange& change) {
  return store_->UpdateCategory(
      name, [&](const StoredCategory& category) -> Result<StoredCategory> {
        GRASPDB_TRY(changed, change(category));
        GRASPDB_TRY_VOID(CheckCategory(changed));
        return std::move(changed);
      });
}

Result<AddedHand> Service::AddHand(const HandFiles& files,
                                   const ExecutionContext& context) {
  GRASPDB_TRY(file, HandFileFromJson(files.annotations));
  StoredHand hand;
  hand.name = file.annotations.name;
  hand.title = file.title;
  hand.sha256 = CalcHandSha256(files);
  hand.urdf = files.urdf;
  hand.annotations = files.annotations;
  GRASPDB_TRY_VOID(CheckName(hand.name, "name"));
  GRASPDB_TRY_VOID(CheckHandMeshes(files));
  if (auto known = store_->FindHand(hand.name);
      known && known->sha256 == hand.sha256) {
    return AddedHand{*std::move(known), false};
  }
  for (const auto& [name, bytes] : files.meshes) {
    DecodeRequest request;
    request.file_name = name;
    request.limits.max_bytes = options_.max_mesh_bytes;
    request.limits.max_triangles = kMostPieceTriangles;
    auto decoded = decoder_->Decode(
        {reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()}, request,
        context);
    if (!decoded) {
      Error error = decoded.error();
      error.message = name + ": " + error.message;
      return error;
    }
    hand.meshes.emplace_back(name, std::move(decoded->mesh_O));
  }
  if (const auto model = BuildHand(hand, *decoder_, context); !model) {
    return model.error();
  }
  GRASPDB_TRY(stored, store_->InsertHand(hand));
  return AddedHand{std::move(stored), true};
}

Result<std::shared_ptr<const HandModel>> Service::FindHandModel(
    const std::string& name, const ExecutionContext& context) const {
  if (auto known = hands_.Find(name)) return *std::move(known);
  // Each starts a helper: one after the other, and each hand once.
  const std::lock_guard lock(hand_mutex_);
  if (auto known = hands_.Find(name)) return *std::move(known);
  if (context.Cancelled()) {
    return Error{ErrorCode::kCancelled, "Reading the hand was cancelled."};
  }
  GRASPDB_TRY(hand, store_->FindHand(name));
  GRASPDB_TRY(model, BuildHand(hand, *decoder_, context));
  hands_.Insert(name, model, CalcHandBytes(*model, 100));
  return std::move(model);
}

Result<std::shared_ptr<const HandShape>> Service::FindHandShape(
    const std::string& name, const ExecutionContext& context) const {
  if (auto known = hand_shapes_.Find(name)) return *std::move(known);
  GRASPDB_TRY(model, FindHandModel(name, context));
  auto shape = std::make_shared<const HandShape>(model);
  hand_shapes_.Insert(name, shape, CalcHandBytes(*model, 1000));
  return std::shared_ptr<const HandShape>(std::move(shape));
}

Result<std::shared_ptr<const Solid>> Service::FindWholeSolid(
    const std::string& id) {
  if (auto known = whole_solids_.Find(id)) return *std::move(known);
  GRASPDB_TRY(meshes, store_->ReadObjectMeshes(id));
  auto solid = std::make_shared<const Solid>(std::move(meshes.work));
  whole_solids_.Insert(id, solid, solid->CalcBytes());
  return std::shared_ptr<const Solid>(std::move(solid));
}

Result<void> Service::CheckQuery(const GraspQuery& query) const {
  if (!query.category.empty()) {
    GRASPDB_TRY_VOID(store_->FindCategory(query.category));
  }
  if (!query.hand.empty()) {
    GRASPDB_TRY_VOID(FindHandModel(query.hand));
  }
  if (!query.object_id.empty()) {
    GRASPDB_TRY_VOID(store_->FindObject(query.object_id));
  }
  if (!query.grasp_space_id.empty()) {
    GRASPDB_TRY_VOID(store_->FindGraspSpace(query.grasp_space_id));
  }
  if (!query.transfer_id.empty()) {
    GRASPDB_TRY_VOID(store_->FindTransfer(query.transfer_id));
  }
  return {};
}

template <class Item>
Result<Page<Item>> Service::Query(const GraspSearch& search,
                                  FindPage<Item> find) const {
  GRASPDB_TRY(query, MakeQuery(search));
  if (!query) return Page<Item>();
  GRASPDB_TRY(page, (*store_.*find)(*query));
  // Whoever finds grasps has named what exists.
  if (page.items.empty()) GRASPDB_TRY_VOID(CheckQuery(*query));
  return std::move(page);
}

Result<Page<StoredGrasp>> Service::QueryGrasps(
    const GraspSearch& search) const {
  return Query<StoredGrasp>(search, &Store::QueryGrasps);
}

Result<Page<GraspKey>> Service::QueryGraspKeys(
    const GraspSearch& search) const {
  return Query<GraspKey>(search, &Store::QueryGraspKeys);
}

Result<std::optional<GraspQuery>> Service::MakeQuery(
    const GraspSearch& search) const {
  std::optional<GraspQuery> query = search.query;
  if (search.task.empty()) return query;
  if (!query->part_labels.empty()) {
    return Error{ErrorCode::kInvalidArgument, "Give parts or a task, not both.",
                 "", "task"};
  }
  if (query->category.empty()) {
    return Error{ErrorCode::kInvalidArgument,
                 "What serves a task depends on the category.",
                 "name the category too", "category"};
  }
  GRASPDB_TRY(category, store_->FindCategory(query->category));
  query->part_labels = FindPartsForTask(category, search.task);
  if (query->part_labels.empty()) return std::optional<GraspQuery>();
  query->keep_free = FindPartsKeptFree(category, search.task);
  query->min_clearance = TransferLimits().min_clearance;
  return query;
}

Result<std::shared_ptr<void>> Service::HoldKey(const std::string& key) {
  const std::lock_guard lock(keys_mutex_);
  if (!held_keys_.insert(key).second) {
    return Error{ErrorCode::kConflict,
                 "A request with this Idempotency-Key is being answered.",
                 "send it again in a moment", "Idempotency-Key"};
  }
  return std::shared_ptr<void>(nullptr, [this, key](void*) {
    const std::lock_guard release(keys_mutex_);
    held_keys_.erase(key);
  });
}

// ---- Jobs -------------------------------------------------------------------

Result<StoredJob> Service::Submit(JobKind kind, bool slow,
                                  const std::string& request,
                                  const std::string& payload,
                                  const JobTerms& terms) {
  GRASPDB_TRY_VOID(runner_->FailOverdue());
  GRASPDB_TRY(job, store_->InsertJob(kind, slow, request, payload, terms,
                                     options_.max_queued_jobs));
  runner_->Wake();
  return job;
}

Result<StoredJob> Service::SubmitImport(const ImportOrder& order,
                                        const JobTerms& terms) {
  GRASPDB_TRY(checked, CheckImport(order));
  const bool slow = checked.role == ObjectRole::kExample && checked.learn;
  return Submit(JobKind::kImport, slow, ToJson(checked), MakePayload(checked),
                terms);
}

Result<StoredJob> Service::SubmitLearn(const LearnOrder& order,
                                       const JobTerms& terms) {
  GRASPDB_TRY_VOID(CheckLearn(order));
  return Submit(JobKind::kLearn, true, ToJson(order), "", terms);
}

Result<StoredJob> Service::SubmitTransfer(const TransferOrder& order,
                                          const JobTerms& terms) {
  GRASPDB_TRY(checked, CheckTransfer(order));
  return Submit(JobKind::kTransfer, false, ToJson(checked),
                MakePayload(checked.mesh), terms);
}

Result<StoredJob> Service::SubmitSegment(const SegmentOrder& order,
                                         const JobTerms& terms) {
  GRASPDB_TRY(object, store_->FindObject(order.object_id));
  if (!order.category.empty() && order.category != "auto") {
    const auto category = store_->FindCategory(order.category);
    if (!category) return category.error();
  }
  if (!order.face_labels.empty()) {
    GRASPDB_TRY_VOID(CheckFaceLabels(order.face_labels, object.num_triangles));
  }
  // Face labels may be many: they go when the job has ended.
  return Submit(JobKind::kSegment, false,
                DumpJson({{"object", order.object_id}}), ToJson(order), terms);
}

Result<StoredJob> Service::SubmitVerify(const VerifyOrder& order,
                                        const JobTerms& terms) {
  if (order.limit < 1 || order.limit > kMostVerified) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("limit must lie in 1..{}.", kMostVerified), "",
                 "limit"};
  }
  GRASPDB_TRY_VOID(CheckQuery(order.query));
  return Submit(JobKind::kVerify, true, ToJson(order), "", terms);
}

Result<StoredJob> Service::FindJob(const std::string& id) const {
  return runner_->Find(id);
}

Result<Page<StoredJob>> Service::ListJobs(std::optional<JobState> state,
                                          const PageRequest& page) const {
  GRASPDB_TRY(jobs, store_->ListJobs(state, page));
  for (StoredJob& job : jobs.items) runner_->AddLiveState(job);
  return std::move(jobs);
}

Result<StoredJob> Service::WaitForJob(const std::string& id,
                                      std::chrono::milliseconds timeout) const {
  return runner_->WaitUntil(id, timeout,
                            [](const StoredJob&) { return false; });
}

Result<StoredJob> Service::WaitForChange(
    const StoredJob& seen, std::chrono::milliseconds timeout) const {
  return runner_->WaitUntil(seen.id, timeout, [&](const StoredJob& job) {
    return job.state != seen.state || job.stage != seen.stage ||
           job.progress != seen.progress ||
           job.grasps_found != seen.grasps_found;
  });
}

std::vector<LiveGrasp> Service::ReadLiveGrasps(const std::string& job_id,
                                               size_t first) const {
  return runner_->ReadLiveGrasps(job_id, first);
}

Result<StoredJob> Service::CancelJob(const std::string& id) {
  return runner_->Cancel(id);
}

Result<void> Service::StartWorkers(JobObserver observer) {
  return runner_->Start(std::move(observer));
}
void Service::StopWorkers() { runner_->Stop(); }

}  // namespace graspdb
