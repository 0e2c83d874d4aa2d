#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "engine/admission/mesh_format.h"
#include "server/codec/parameters_json.h"
#include "server/decode/decode_client.h"
#include "server/ids.h"
#include "server/jobs/segmentation.h"
#include "server/jobs/service.h"

namespace graspdb {
namespace {

// Not the request's: what is stored must not depend on who asked first.
constexpr uint64_t kImportSeed = 1;
constexpr char kAuto[] = "auto";
// Stored as the units of an object whose file names its own.
constexpr char kFileUnits[] = "file";

bool HasOwnUnit(const ImportOrder& order) {
  const auto format =
      order.format.empty()
          ? GuessMeshFormat(
                {reinterpret_cast<const uint8_t*>(order.bytes.data()),
                 order.bytes.size()},
                order.file_name)
          : ParseMeshFormat(order.format);
  return format && *format == MeshFormat::kDae;
}

StoredObject DescribeObject(const ImportOrder& order,
                            const DecodedMesh& decoded) {
  StoredObject object;
  object.sha256 = CalcSha256(order.bytes);
  object.role = order.role;
  object.name = order.name;
  object.file_name = order.file_name;
  for (const char c : decoded.format) {
    object.format += static_cast<char>(std::tolower(c));
  }
  object.units = order.units;
  object.num_bytes = std::ssize(order.bytes);
  object.num_triangles = decoded.mesh_O.num_triangles();
  object.num_work_triangles = decoded.work_O.num_triangles();
  object.box_min = decoded.mesh_O.box_min();
  object.box_max = decoded.mesh_O.box_max();
  object.mass = decoded.mass;
  object.repairs = decoded.repairs;
  if (decoded.cloud) {
    object.cloud = {decoded.cloud->report, decoded.cloud->seen_share};
  }
  return object;
}

Result<SegmentedObject> SegmentNewObject(const Store& store,
                                         const ImportOrder& order,
                                         const ObjectMeshes& meshes,
                                         ExecutionContext& context) {
  if (order.category == kAuto) {
    return SegmentByAnyCategory(store, meshes, "", kImportSeed, context);
  }
  GRASPDB_TRY(category, store.FindCategory(order.category));
  if (!order.face_labels.empty()) {
    return SegmentByLabels(category, meshes, order.face_labels, context);
  }
  return SegmentByExamples(store, category, category.segmentation, meshes, "",
                           kImportSeed, context);
}

// An example must show its parts beyond doubt.
Result<void> CheckExample(const Store& store,
                          const SegmentedObject& segmented) {
  GRASPDB_TRY(category, store.FindCategory(segmented.category));
  const bool by_hand = segmented.record.method == "labels";
  if (by_hand ? !segmented.parts.empty()
              : segmented.parts.size() == category.parts.size() &&
                    segmented.record.verdict !=
                        ToString(SegmentationVerdict::kForeign)) {
    return {};
  }
  return Error{ErrorCode::kNotInCategory,
               fmt::format("The mesh is not like the examples of '{}' "
                           "(similarity {:.2f}).",
                           segmented.category, segmented.record.similarity),
               "send it with one label per face", "face_labels"};
}

Result<ImportResult> StoreSegmentation(Store& store, const StoredObject& object,
                                       const SegmentedObject& segmented,
                                       bool cascade,
                                       const Store::PartIds& instead_of = {}) {
  if (object.role == ObjectRole::kExample) {
    GRASPDB_TRY_VOID(CheckExample(store, segmented));
  }
  GRASPDB_TRY(stored, store.ReplaceParts(object.id, segmented.category,
                                         segmented.record, segmented.meshes,
                                         segmented.parts, segmented.solids,
                                         cascade, instead_of));
  GRASPDB_TRY(parts, store.ListParts(stored.id));
  return ImportResult{stored, parts, false};
}

}  // namespace

Result<DecodedMesh> Service::DecodeUpload(
    const ImportOrder& order, const ExecutionContext& context) const {
  DecodeRequest request;
  if (!order.format.empty()) {
    GRASPDB_TRY(format, ParseMeshFormat(order.format));
    request.format = format;
  }
  if (order.units != kFileUnits) {
    GRASPDB_TRY(metres_per_unit, ParseUnits(order.units));
    request.metres_per_unit = metres_per_unit;
  }
  request.file_name = order.file_name;
  request.limits.max_bytes = options_.max_mesh_bytes;
  request.limits.max_triangles = options_.max_triangles;
  return decoder_->Decode({reinterpret_cast<const uint8_t*>(order.bytes.data()),
                           order.bytes.size()},
                          request, context);
}

Result<ImportOrder> Service::CheckImport(const ImportOrder& order) const {
  ImportOrder checked = order;
  if (checked.units.empty()) {
    checked.units = HasOwnUnit(order) ? kFileUnits : "m";
  } else if (checked.units == kFileUnits && HasOwnUnit(order)) {
    // It was filled in before.
  } else if (const auto units = ParseUnits(checked.units); !units) {
    return units.error();
  }
  if (!order.format.empty()) {
    if (const auto format = ParseMeshFormat(order.format); !format) {
      return format.error();
    }
  }
  constexpr size_t kMostName = 255;  // As most file systems take.
  if (order.file_name.size() > kMostName || order.name.size() > kMostName) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("A name has at most {} bytes.", kMostName), "",
                 order.name.size() > kMostName ? "name" : "mesh"};
  }
  if (order.bytes.empty()) {
    const auto format = ParseMeshFormat(order.format);
    return Error{ErrorCode::kUnusableInput,
                 format ? fmt::format("The {} file is empty.", GetName(*format))
                        : "The mesh is empty.",
                 kFormatHint, "mesh"};
  }
  if (std::ssize(order.bytes) > options_.max_mesh_bytes) {
    return Error{ErrorCode::kTooLarge,
                 fmt::format("The mesh has {} bytes; at most {} are taken.",
                             order.bytes.size(), options_.max_mesh_bytes),
                 "reduce it", "mesh"};
  }
  if (!order.category.empty() && order.category != kAuto) {
    GRASPDB_TRY(category, store_->FindCategory(order.category));
    GRASPDB_TRY_VOID(IndexLabels(category, order.face_labels));
  } else if (order.role == ObjectRole::kExample) {
    return Error{ErrorCode::kInvalidArgument, "An example needs a category.",
                 "name one of GET /v1/categories", "category"};
  } else if (!order.face_labels.empty()) {
    return Error{ErrorCode::kInvalidArgument, "Face labels need a category.",
                 "name one of GET /v1/categories", "category"};
  }
  return checked;
}

Result<ImportResult> Service::ImportObject(const ImportOrder& order,
                                           ExecutionContext& context) {
  GRASPDB_TRY(checked, CheckImport(order));
  if (checked.category != kAuto) {
    GRASPDB_TRY(known, store_->FindObjectByContent(CalcSha256(checked.bytes),
                                                   checked.units, checked.role,
                                                   checked.category));
    if (known) {
      GRASPDB_TRY(parts, store_->ListParts(known->id));
      return ImportResult{*known, parts, false};
    }
  }
  return ImportNewObject(checked, context);
}

Result<ImportResult> Service::ImportNewObject(const ImportOrder& order,
                                              ExecutionContext& context) {
  context.ReportProgress("decode", 0.0);
  GRASPDB_TRY(decoded, DecodeUpload(order, context));
  NewObject object;
  object.record = DescribeObject(order, decoded);
  object.bytes = order.bytes;
  object.meshes.canonical = std::move(decoded.mesh_O);
  object.meshes.work = std::move(decoded.work_O);
  if (decoded.cloud) {
    object.meshes.cloud = std::move(decoded.cloud->points_O);
    object.meshes.cloud_report = decoded.cloud->report;
  }
  if (!order.category.empty()) {
    context.ReportProgress("segment", 0.3);
    GRASPDB_TRY(segmented,
                SegmentNewObject(*store_, order, object.meshes, context));
    if (order.role == ObjectRole::kExample) {
      GRASPDB_TRY_VOID(CheckExample(*store_, segmented));
    }
    object.record.category = segmented.category;
    object.record.segmentation = std::move(segmented.record);
    object.meshes = std::move(segmented.meshes);
    object.parts = std::move(segmented.parts);
    object.solids = std::move(segmented.solids);
  }
  context.ReportProgress("store", 0.9);
  bool created = false;
  GRASPDB_TRY(stored, store_->InsertObject(object, &created));
  GRASPDB_TRY(parts, store_->ListParts(stored.id));
  context.ReportProgress("store", 1.0);
  return ImportResult{stored, parts, created};
}

Result<ImportResult> Service::Resegment(const SegmentOrder& order,
                                        ExecutionContext& context) {
  GRASPDB_TRY(object, store_->FindObject(order.object_id));
  GRASPDB_TRY(meshes, store_->ReadObjectMeshes(object.id));
  const std::string name =
      order.category.empty() ? object.category : order.category;
  if (name == kAuto) {
    GRASPDB_TRY(segmented, SegmentByAnyCategory(*store_, meshes, object.id,
                                                order.seed, context));
    return StoreSegmentation(*store_, object, segmented, order.cascade);
  }
  if (name.empty()) {
    return Error{ErrorCode::kInvalidArgument,
                 "The object has no category to segment it by.",
                 "name one, or auto", "category"};
  }
  GRASPDB_TRY(category, store_->FindCategory(name));
  if (!order.face_labels.empty()) {
    GRASPDB_TRY(segmented,
                SegmentByLabels(category, meshes, order.face_labels, context));
    return StoreSegmentation(*store_, object, segmented, order.cascade);
  }
  SegmentationParameters parameters = category.segmentation;
  if (!order.settings.empty()) {
    GRASPDB_TRY(changed, SegmentationFromJson(order.settings, parameters));
    parameters = changed;
  }
  GRASPDB_TRY(segmented,
              SegmentByExamples(*store_, category, parameters, meshes,
                                object.id, order.seed, context));
  return StoreSegmentation(*store_, object, segmented, order.cascade);
}

Result<ImportResult> Service::Relabel(const std::string& part_id,
                                      const std::string& label, bool cascade) {
  GRASPDB_TRY(part, store_->FindPart(part_id));
  GRASPDB_TRY(object, store_->FindObject(part.object_id));
  GRASPDB_TRY(before, store_->ListParts(object.id));
  GRASPDB_TRY(category, store_->FindCategory(object.category));
  const std::vector<std::string> labels = MakeVocabulary(category).labels;
  const auto found = std::find(labels.begin(), labels.end(), label);
  if (found == labels.end()) {
    return Error{
        ErrorCode::kInvalidArgument,
        "Category '" + category.name + "' has no part '" + label + "'.",
        fmt::format("known: {}", fmt::join(labels, ", ")), "label"};
  }
  if (label == part.label) return ImportResult{object, before, false};
  std::vector<std::string> instead_of;
  for (const StoredPart& one : before) instead_of.push_back(one.id);
  if (std::find(instead_of.begin(), instead_of.end(), part.id) ==
      instead_of.end()) {
    return Error{ErrorCode::kConflict,
                 "Object " + object.id + " has been cut anew meanwhile.",
                 "send the request again"};
  }
  GRASPDB_TRY(meshes, store_->ReadObjectMeshes(object.id));
  const auto index = static_cast<int>(found - labels.begin());
  std::replace(meshes.canonical_labels.begin(), meshes.canonical_labels.end(),
               part.label_index, index);
  std::replace(meshes.work_labels.begin(), meshes.work_labels.end(),
               part.label_index, index);
  StoredSegmentation record = object.segmentation;
  record.method = "labels";
  record.verdict = ToString(SegmentationVerdict::kMatched);
  record.warnings.clear();
  GRASPDB_TRY(segmented, CutLabelledObject(category, record, meshes));
  return StoreSegmentation(*store_, object, segmented, cascade, instead_of);
}

}  // namespace graspdb
