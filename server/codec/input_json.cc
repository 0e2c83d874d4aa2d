#include "server/codec/input_json.h"

#include <algorithm>

#include <fmt/format.h>

#include "server/codec/json.h"
#include "server/codec/label_limits.h"
#include "server/codec/parameters_json.h"

namespace graspdb {
namespace {

Error Invalid(const std::string& message, const std::string& field) {
  return Error{ErrorCode::kInvalidArgument, message, "", field};
}

// ---- Categories -------------------------------------------------------------

// Notes by task.
void ReadNotes(JsonFields& fields, const std::string& name,
               std::map<std::string, std::string>& notes) {
  const Json* json = fields.Find(name);
  if (json == nullptr) return;
  if (!json->is_object() || json->size() > kMostTasks) {
    return fields.Fail(
        name, fmt::format("an object of at most {} notes by task", kMostTasks));
  }
  for (const auto& [task, note] : json->items()) {
    if (!note.is_string()) return fields.Fail(name + "." + task, "text");
    notes[task] = note.get<std::string>();
  }
}

void ReadParts(JsonFields& fields, std::vector<CategoryPart>& parts) {
  const Json* json = fields.Find("parts");
  if (json == nullptr) return;
  if (!json->is_array() || json->size() > kMostParts) {
    return fields.Fail("parts",
                       fmt::format("a list of at most {} parts", kMostParts));
  }
  parts.clear();
  for (size_t i = 0; i < json->size(); ++i) {
    const std::string path = "parts[" + std::to_string(i) + "]";
    JsonFields entry((*json)[i], path);
    CategoryPart part;
    entry.RequireText("label", part.label);
    ReadNotes(entry, "tasks", part.tasks);
    ReadNotes(entry, "keep_free", part.keep_free);
    for (const auto& [task, note] : part.keep_free) {
      if (part.tasks.contains(task)) {
        entry.Fail("keep_free", "tasks that do not hold this part");
      }
    }
    if (const auto read = entry.Finish(); !read) fields.Fail(read.error());
    parts.push_back(std::move(part));
  }
}

// Pairs of labels stay so, wherever the labels stand now; those of a label that
// is gone go.
void MoveTopology(const std::vector<CategoryPart>& before,
                  StoredCategory& category) {
  const std::map<std::string, int> indices = IndexParts(category.parts);
  const auto index_of = [&](int old) {
    const auto found = indices.find(before[static_cast<size_t>(old)].label);
    return found == indices.end() ? -1 : found->second;
  };
  for (auto& [a, b] : category.adjacency) {
    a = index_of(a);
    b = index_of(b);
  }
  std::erase_if(category.adjacency, [](const std::pair<int, int>& pair) {
    return pair.first < 0 || pair.second < 0;
  });
}

// Pairs of labels become pairs of label indices.
void ReadTopology(JsonFields& fields, StoredCategory& category) {
  const Json* json = fields.Find("topology");
  if (json == nullptr) return;
  const char* takes = "a list of pairs of the category's labels";
  if (!json->is_array() || json->size() > kMostParts * (kMostParts - 1) / 2) {
    return fields.Fail("topology", takes);
  }
  category.adjacency.clear();
  const std::map<std::string, int> indices = IndexParts(category.parts);
  const auto index_of = [&](const Json& label) {
    if (!label.is_string()) return -1;
    const auto found = indices.find(label.get<std::string>());
    return found == indices.end() ? -1 : found->second;
  };
  for (const Json& pair : *json) {
    if (!pair.is_array() || pair.size() != 2) {
      return fields.Fail("topology", takes);
    }
    const int a = index_of(pair[0]);
    const int b = index_of(pair[1]);
    if (a < 0 || b < 0 || a == b) return fields.Fail("topology", takes);
    category.adjacency.emplace_back(a, b);
  }
}

void ReadCategoryFields(JsonFields& fields, StoredCategory& category) {
  fields.Read("title", category.title);
  const std::vector<CategoryPart> before = category.parts;
  ReadParts(fields, category.parts);
  MoveTopology(before, category);
  ReadTopology(fields, category);
  if (const Json* settings = fields.Find("segmentation")) {
    auto read =
        SegmentationFromJson(DumpJson(*settings), category.segmentation);
    if (read) {
      category.segmentation = *read;
    } else {
      fields.Fail(read.error());
    }
  }
}

std::vector<CategoryExample> ReadExamples(JsonFields& fields,
                                          const std::string& name) {
  std::vector<CategoryExample> examples;
  const Json* json = fields.Find(name);
  if (json == nullptr) return examples;
  if (!json->is_array()) {
    fields.Fail(name, "a list of meshes");
    return examples;
  }
  for (size_t i = 0; i < json->size(); ++i) {
    JsonFields entry((*json)[i], name + "[" + std::to_string(i) + "]");
    CategoryExample example;
    entry.RequireText("name", example.name);
    entry.RequireText("mesh", example.mesh);
    entry.Read("labels", example.labels);
    if (const auto read = entry.Finish(); !read) fields.Fail(read.error());
    examples.push_back(std::move(example));
  }
  return examples;
}

// ---- Labels -----------------------------------------------------------------

// As a part's label must be: what is repeated per face is not to be long.
bool IsLabel(const std::string& text) {
  return !text.empty() && text.size() <= 64 &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
                  c == '_' || c == '-';
         });
}

// {"body": [[0, 10]], ...}: half-open ranges that together cover all faces.
Result<std::vector<std::string>> ExpandRanges(const Json& faces) {
  struct Range {
    int begin;
    int end;
    std::string label;
  };
  const std::string takes =
      "faces must map each label to half-open ranges [begin, end).";
  if (!faces.is_object()) return Invalid(takes, "faces");
  std::vector<Range> ranges;
  for (const auto& [label, list] : faces.items()) {
    if (!IsLabel(label)) return Invalid(takes, "faces");
    if (!list.is_array()) return Invalid(takes, "faces." + label);
    for (const Json& range : list) {
      const bool sound = range.is_array() && range.size() == 2 &&
                         range[0].is_number_unsigned() &&
                         range[1].is_number_unsigned() &&
                         range[1].get<uint64_t>() <= kMostFaces &&
                         range[0].get<uint64_t>() < range[1].get<uint64_t>();
      if (!sound) return Invalid(takes, "faces." + label);
      ranges.push_back({range[0].get<int>(), range[1].get<int>(), label});
    }
  }
  std::sort(ranges.begin(), ranges.end(),
            [](const Range& a, const Range& b) { return a.begin < b.begin; });
  std::vector<std::string> labels;
  for (const Range& range : ranges) {
    if (range.begin != static_cast<int>(labels.size())) {
      return Invalid("The ranges of faces overlap or leave out face " +
                         std::to_string(labels.size()) + ".",
                     "faces." + range.label);
    }
    labels.resize(static_cast<size_t>(range.end), range.label);
  }
  return labels;
}

// ---- Hands ------------------------------------------------------------------

// Calls read(JsonFields& entry) for each entry of a list of objects.
template <class F>
void ReadEntries(JsonFields& fields, const std::string& name, F&& read) {
  const Json* json = fields.Find(name);
  if (json == nullptr) return;
  if (!json->is_array()) return fields.Fail(name, "a list");
  for (size_t i = 0; i < json->size(); ++i) {
    JsonFields entry((*json)[i], name + "[" + std::to_string(i) + "]");
    read(entry);
    if (const auto done = entry.Finish(); !done) fields.Fail(done.error());
  }
}

void ReadIgnoredCollisions(JsonFields& fields, HandAnnotations& annotations) {
  const Json* json = fields.Find("ignored_collisions");
  if (json == nullptr) return;
  const char* takes = "a list of pairs of links";
  if (!json->is_array()) return fields.Fail("ignored_collisions", takes);
  for (const Json& pair : *json) {
    if (!pair.is_array() || pair.size() != 2 || !pair[0].is_string() ||
        !pair[1].is_string()) {
      return fields.Fail("ignored_collisions", takes);
    }
    annotations.ignored_collisions.emplace_back(pair[0], pair[1]);
  }
}

void ReadAnnotations(JsonFields& fields, HandAnnotations& annotations) {
  fields.RequireText("name", annotations.name);
  fields.Read("approach_axis_H", annotations.approach_H);
  const double norm = annotations.approach_H.norm();
  if (!(std::abs(norm - 1.0) < 1e-6)) {
    fields.Fail("approach_axis_H", "a unit vector");
  }
  fields.Read("closing_force_n", annotations.closing_force);
  if (!(annotations.closing_force > 0.0)) {
    fields.Fail("closing_force_n", "more than 0 N");
  }
  ReadEntries(fields, "actuators", [&](JsonFields& entry) {
    HandAnnotations::Actuator& actuator = annotations.actuators.emplace_back();
    entry.RequireText("name", actuator.name);
    entry.RequireText("joint", actuator.joint);
    entry.Read("closes", actuator.closes);
  });
  ReadEntries(fields, "breakaway", [&](JsonFields& entry) {
    HandAnnotations::Breakaway& breakaway =
        annotations.breakaway.emplace_back();
    entry.RequireText("joint", breakaway.joint);
    entry.RequireText("released_joint", breakaway.released_joint);
    entry.Read("ratio", breakaway.ratio);
  });
  ReadEntries(fields, "contact_points", [&](JsonFields& entry) {
    HandAnnotations::ContactPoint& point =
        annotations.contact_points.emplace_back();
    entry.RequireText("link", point.link);
    entry.Require("p_L");
    entry.Read("p_L", point.p_L);
    entry.Require("nhat_L");
    entry.Read("nhat_L", point.nhat_L);
    point.nhat_L.normalize();
  });
  ReadIgnoredCollisions(fields, annotations);
}

void ReadGraspit(JsonFields& fields, std::optional<GraspitModel>& graspit) {
  const Json* json = fields.Find("graspit");
  if (json == nullptr) return;
  JsonFields entry(*json, "graspit");
  graspit.emplace();
  entry.RequireText("robot", graspit->robot);
  Eigen::Vector3d x_axis_H = Eigen::Vector3d::UnitX();
  Eigen::Vector3d z_axis_H = Eigen::Vector3d::UnitZ();
  entry.Read("x_axis_H", x_axis_H);
  entry.Read("z_axis_H", z_axis_H);
  entry.Read("p_HG", graspit->X_HG.translation);
  Eigen::Matrix3d& R_HG = graspit->X_HG.rotation;
  R_HG << x_axis_H, z_axis_H.cross(x_axis_H), z_axis_H;
  if (!(R_HG.transpose() * R_HG).isIdentity(1e-6)) {
    entry.Fail("x_axis_H", "a unit vector, at right angles to z_axis_H");
  }
  if (const auto read = entry.Finish(); !read) fields.Fail(read.error());
}

}  // namespace

Result<StoredCategory> CategoryFromJson(const std::string& text) {
  GRASPDB_TRY(json, ParseJson(text));
  JsonFields fields(json, "");
  StoredCategory category;
  fields.RequireText("name", category.name);
  fields.Require("parts");
  ReadCategoryFields(fields, category);
  GRASPDB_TRY_VOID(fields.Finish());
  return category;
}

Result<StoredCategory> PatchCategory(const StoredCategory& category,
                                     const std::string& text) {
  GRASPDB_TRY(json, ParseJson(text));
  JsonFields fields(json, "");
  StoredCategory patched = category;
  ReadCategoryFields(fields, patched);
  GRASPDB_TRY_VOID(fields.Finish());
  return patched;
}

Result<CategoryFile> CategoryFileFromJson(const std::string& text) {
  GRASPDB_TRY(json, ParseJson(text));
  JsonFields fields(json, "");
  CategoryFile file;
  fields.RequireText("name", file.category.name);
  fields.Require("parts");
  ReadCategoryFields(fields, file.category);
  file.examples = ReadExamples(fields, "examples");
  file.novel = ReadExamples(fields, "novel");
  GRASPDB_TRY_VOID(fields.Finish());
  return file;
}

std::vector<std::string> ReadFaceLabels(JsonFields& fields) {
  std::vector<std::string> labels;
  fields.Read("face_labels", labels);
  if (labels.size() > kMostFaces) {
    fields.Fail("face_labels",
                "at most " + std::to_string(kMostFaces) + " labels");
  }
  if (const Json* faces = fields.Find("faces")) {
    auto expanded = ExpandRanges(*faces);
    if (expanded) {
      labels = std::move(*expanded);
    } else {
      fields.Fail(expanded.error());
    }
  }
  return labels;
}

Result<std::vector<std::string>> FaceLabelsFromJson(std::string_view text) {
  GRASPDB_TRY(json, ParseJson(text, kLabelLimits));
  JsonFields fields(json, "");
  std::vector<std::string> vocabulary;
  fields.Read("labels", vocabulary);
  const std::vector<std::string> labels = ReadFaceLabels(fields);
  GRASPDB_TRY_VOID(fields.Finish());
  if (labels.empty()) return Invalid("There are no face labels.", "faces");
  return labels;
}

Result<HandFile> HandFileFromJson(const std::string& text) {
  GRASPDB_TRY(json, ParseJson(text));
  JsonFields fields(json, "");
  HandFile file;
  fields.Read("title", file.title);
  fields.Read("urdf", file.urdf);
  std::string ignored;  // For people.
  fields.Read("licence", ignored);
  fields.Read("source", ignored);
  ReadAnnotations(fields, file.annotations);
  ReadGraspit(fields, file.graspit);
  GRASPDB_TRY_VOID(fields.Finish());
  if (file.title.empty()) file.title = file.annotations.name;
  return file;
}

Result<std::string> PartLabelFromJson(const std::string& text) {
  GRASPDB_TRY(json, ParseJson(text));
  JsonFields fields(json, "");
  std::string label;
  fields.RequireText("label", label);
  GRASPDB_TRY_VOID(fields.Finish());
  return label;
}

}  // namespace graspdb
