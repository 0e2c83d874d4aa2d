#pragma once

#include <string>
#include <utility>
#include <vector>

#include "engine/base/result.h"
#include "engine/hand/hand_maker.h"
#include "server/records.h"

/** @file
 What data files and the catalogue's requests say as JSON. Every reader answers
 kInvalidArgument with the field at fault and what it takes; unknown fields are
 refused. */

namespace graspdb {

class JsonFields;

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

/** Those that an object has, in either way of FaceLabelsFromJson(); none when
 there are none. A fault is told to `fields`. */
std::vector<std::string> ReadFaceLabels(JsonFields& fields);

/** labels.json, {"labels": [...], "faces": {"body": [[0, 1500]], ...}} with
 half-open ranges, or {"face_labels": ["body", ...]}: one label per face.
 @retval kInvalidArgument when ranges overlap or leave a face out. */
Result<std::vector<std::string>> FaceLabelsFromJson(std::string_view text);

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

}  // namespace graspdb
