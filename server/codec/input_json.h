#pragma once

#include <string>
#include <utility>
#include <vector>

#include "engine/base/result.h"
#include "engine/hand/hand_maker.h"
#include "server/orders.h"
#include "server/records.h"

/** @file
 What users and data files send as JSON. Every reader answers kInvalidArgument
 with the field at fault and what it takes; unknown fields are refused. */

namespace graspdb {

/** POST /v1/categories, and the head of category.json:
 {"name", "title", "parts": [{"label", "tasks": {"use": "note"}}],
  "topology": [["body", "handle"]], "segmentation": {...}}. */
Result<StoredCategory> CategoryFromJson(const std::string& text);

/** PATCH /v1/categories/{name}: `category` with the given fields replaced. */
Result<StoredCategory> PatchCategory(const StoredCategory& category,
                                     const std::string& text);

/** One entry of a category folder; paths are relative to the folder. */
struct CategoryExample {
  std::string name;
  std::string mesh;
  std::string labels;  ///< Empty when there is no label file.
};

/** A whole category.json. */
struct CategoryFile {
  StoredCategory category;
  std::vector<CategoryExample> examples;
  std::vector<CategoryExample> novel;
};
Result<CategoryFile> CategoryFileFromJson(const std::string& text);

/** labels.json, {"labels": [...], "faces": {"body": [[0, 1500]], ...}} with
 half-open ranges, or {"face_labels": ["body", ...]}: one label per face.
 @retval kInvalidArgument when ranges overlap or leave a face out. */
Result<std::vector<std::string>> FaceLabelsFromJson(const std::string& text);

/** The same hand among the robots of GraspIt!. */
struct GraspitModel {
  std::string robot;    ///< Its file, below the folder $GRASPIT.
  RigidTransform X_HG;  ///< The frame of its palm.
};

/** hand.json, see data/hands. */
struct HandFile {
  std::string title;
  std::string urdf{"hand.urdf"};  ///< File name of the URDF.
  HandAnnotations annotations;
  std::optional<GraspitModel> graspit;
};
Result<HandFile> HandFileFromJson(const std::string& text);

/** PATCH /v1/parts/{id}: {"label": "handle"}. */
Result<std::string> PartLabelFromJson(const std::string& text);

/** POST /v1/objects/{id}/segmentation: {"category", "settings": {...},
 "face_labels": [...] or "faces": {...} as in labels.json, "seed"}, all
 optional. object_id and cascade are the caller's. */
Result<SegmentOrder> SegmentOrderFromJson(const std::string& text);

/** POST /v1/objects/{id}/grasp-spaces: {"parts": [...], "hands": [...],
 "parameters": {...}, "seed"}, all optional; object_id is the caller's. */
Result<LearnOrder> LearnOrderFromJson(const std::string& text);

/** POST /v1/verifications: {"category", "parts": [...], "hand", "object",
 "grasp_space", "transfer", "stage", "limit", "again"}, all optional; no more
 than 1000 grasps unless limit says. */
Result<VerifyOrder> VerifyOrderFromJson(const std::string& text);

// Orders in the jobs table, whole but for the bytes of a mesh.
std::string ToJson(const SegmentOrder& order);
std::string ToJson(const VerifyOrder& order);  ///< As POST /v1/verifications.
std::string ToJson(const ImportOrder& order);
std::string ToJson(const LearnOrder& order);
std::string ToJson(const TransferOrder& order);
Result<ImportOrder> StoredImportOrderFromJson(const std::string& text);
Result<SegmentOrder> StoredSegmentOrderFromJson(const std::string& text);
Result<LearnOrder> StoredLearnOrderFromJson(const std::string& text);
Result<TransferOrder> StoredTransferOrderFromJson(const std::string& text);

}  // namespace graspdb
