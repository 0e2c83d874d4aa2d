#include "server/codec/record_json.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "server/codec/encode.h"
#include "server/codec/parameters_json.h"
#include "server/ids.h"

namespace graspdb {

Json Encode(const Eigen::Vector3d& vector) {
  return Json::array({vector.x(), vector.y(), vector.z()});
}

Json Encode(const RigidTransform& X) {
  Eigen::Quaterniond q(X.rotation);
  q.normalize();
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  Json json;
  json["position"] = Encode(X.translation);
  json["orientation"] = {
      {"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
  return json;
}

namespace {

using graspdb::Encode;

Json Encode(const StoredSegmentation& segmentation) {
  if (segmentation.method.empty()) return nullptr;
  Json json;
  json["method"] = segmentation.method;
  json["verdict"] = segmentation.verdict;
  if (segmentation.example_id.empty()) {
    json["example"] = nullptr;
    json["alignment"] = nullptr;
  } else {
    json["example"] = segmentation.example_id;
    json["alignment"]["X_NE"] = Encode(segmentation.X_NE);
    json["alignment"]["scale"] = segmentation.scale;
    json["alignment"]["residual"] = segmentation.residual;
  }
  json["similarity"] = segmentation.similarity;
  json["warnings"] = segmentation.warnings;
  return json;
}

Json Encode(const StoredObject& object) {
  Json json;
  json["id"] = object.id;
  json["sha256"] = object.sha256;
  json["role"] = ToString(object.role);
  json["category"] = OrNull(object.category);
  json["name"] = object.name;
  json["file_name"] = object.file_name;
  json["format"] = object.format;
  json["units"] = object.units;
  json["bytes"] = object.num_bytes;
  json["triangles"] = object.num_triangles;
  json["work_triangles"] = object.num_work_triangles;
  json["bounding_box"]["min"] = Encode(object.box_min);
  json["bounding_box"]["max"] = Encode(object.box_max);
  json["mass_properties"]["volume"] = object.mass.volume;
  json["mass_properties"]["area"] = object.mass.area;
  json["mass_properties"]["centre"] = Encode(object.mass.p_McCM);
  json["mass_properties"]["max_radius"] = object.mass.max_radius;
  json["repairs"] = object.repairs;
  json["cloud"] = nullptr;
  if (object.cloud) {
    const CloudReport& report = object.cloud->report;
    json["cloud"] = {{"points", report.num_points},
                     {"outliers", report.num_outliers},
                     {"spacing", report.spacing},
                     {"noise", report.noise},
                     {"one_sided", report.one_sided},
                     {"seen_share", object.cloud->seen_share}};
  }
  json["segmentation"] = Encode(object.segmentation);
  json["created_at"] = object.created_at;
  return json;
}

Json Encode(const StoredPart& part, bool with_faces) {
  Json json;
  json["id"] = part.id;
  json["object"] = part.object_id;
  json["label"] = part.label;
  json["area"] = part.area;
  json["volume"] = part.volume;
  json["confidence"] = part.confidence;
  json["adjacent"] = part.adjacent;
  json["num_faces"] = part.faces.size();
  if (with_faces) json["faces"] = part.faces;
  return json;
}

// Where the grasps are that a job of this kind has judged.
std::string MakeGraspsHref(const Json& order) {
  std::string filters;
  for (const char* name :
       {"category", "hand", "object", "grasp_space", "transfer", "stage"}) {
    const std::string value = order.value(name, "");
    // What exists has a plain name.
    if (!value.empty()) filters += fmt::format("&{}={}", name, value);
  }
  const Json& parts = order.at("parts");
  for (size_t i = 0; i < parts.size(); ++i) {
    filters += (i == 0 ? "&part=" : ",") + parts[i].get<std::string>();
  }
  return "/v1/grasps?sort=merit" + filters;
}

Json EncodeJobResult(const StoredJob& job) {
  if (job.state != JobState::kSucceeded) return nullptr;
  Json json;
  if (job.kind == JobKind::kVerify) {
    json["href"] = MakeGraspsHref(Json::parse(job.request));
    return json;
  }
  const bool transfer = job.kind == JobKind::kTransfer;
  json[transfer ? "transfer" : "object"] = job.result_id;
  json["href"] = (transfer ? "/v1/transfers/" : "/v1/objects/") + job.result_id;
  return json;
}

Json Encode(const std::optional<Error>& error) {
  if (!error) return nullptr;
  Json json;
  json["code"] = ToString(error->code);
  // Those two may tell of files and code of the server; the log has them.
  json["detail"] = error->code == ErrorCode::kInternal
                       ? "The server made a mistake."
                   : error->code == ErrorCode::kStorage
                       ? "The database could not be written or read."
                       : error->message;
  json["hint"] = OrNull(error->hint);
  json["field"] = OrNull(error->field);
  return json;
}

}  // namespace

std::string ListToJson(const std::vector<std::string>& items,
                       const std::string& next_cursor) {
  std::string text = "{\"items\":[";
  for (size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += ',';
    text += items[i];
  }
  return text + "],\"next_cursor\":" + DumpJson(OrNull(next_cursor)) + "}";
}

std::string ToJson(const StoredCategory& category) {
  Json json;
  json["name"] = category.name;
  json["title"] = category.title;
  json["parts"] = Json::array();
  for (const CategoryPart& part : category.parts) {
    Json entry;
    entry["label"] = part.label;
    entry["tasks"] = Json::object();
    for (const auto& [task, note] : part.tasks) entry["tasks"][task] = note;
    entry["keep_free"] = Json::object();
    for (const auto& [task, why] : part.keep_free) {
      entry["keep_free"][task] = why;
    }
    json["parts"].push_back(std::move(entry));
  }
  json["topology"] = Json::array();
  for (const auto& [a, b] : category.adjacency) {
    json["topology"].push_back({category.parts[static_cast<size_t>(a)].label,
                                category.parts[static_cast<size_t>(b)].label});
  }
  json["segmentation"] = Parsed(SegmentationToJson(category.segmentation));
  json["created_at"] = category.created_at;
  return DumpJson(json);
}

std::string ToJson(const StoredObject& object) {
  return DumpJson(Encode(object));
}

std::string ToJson(const StoredObject& object,
                   const std::vector<StoredPart>& parts) {
  Json json = Encode(object);
  json["parts"] = Json::array();
  for (const StoredPart& part : parts) {
    json["parts"].push_back(Encode(part, false));
  }
  return DumpJson(json);
}

std::string ToJson(const SimilarObject& similar) {
  Json json;
  json["object"] = Encode(similar.object);
  json["similarity"] = similar.similarity;
  json["alignment"]["X_NE"] = Encode(similar.X_NE);
  json["alignment"]["scale"] = similar.scale;
  json["alignment"]["residual"] = similar.residual;
  return DumpJson(json);
}

std::string ToJson(const StoredPart& part) {
  return DumpJson(Encode(part, true));
}

std::string ToJson(const StoredHand& hand, const HandModel& model) {
  Json json;
  json["name"] = hand.name;
  json["title"] = hand.title;
  json["sha256"] = hand.sha256;
  json["links"] = Json::array();
  for (const HandLink& link : model.links()) json["links"].push_back(link.name);
  json["joints"] = Json::array();
  for (const HandJoint& joint : model.joints()) {
    Json entry;
    entry["name"] = joint.name;
    entry["type"] =
        joint.type == JointType::kRevolute ? "revolute" : "prismatic";
    entry["lower"] = joint.lower;
    entry["upper"] = joint.upper;
    json["joints"].push_back(std::move(entry));
  }
  json["actuators"] = Json::array();
  for (const HandActuator& actuator : model.actuators()) {
    Json entry;
    entry["name"] = actuator.name;
    entry["joints"] = Json::array();
    for (const int joint : actuator.joints) {
      entry["joints"].push_back(model.joints()[joint].name);
    }
    entry["closes"] = actuator.closes;
    entry["lower"] = actuator.lower;
    entry["upper"] = actuator.upper;
    json["actuators"].push_back(std::move(entry));
  }
  json["contact_points"] = model.contact_points().size();
  json["approach_axis_H"] = Encode(model.approach_H());
  json["closing_force"] = model.closing_force();
  json["created_at"] = hand.created_at;
  return DumpJson(json);
}

std::string ToJson(const StoredGraspSpace& space) {
  Json json;
  json["id"] = space.id;
  json["object"] = space.object_id;
  json["category"] = space.category;
  json["part"] = space.part_label;
  json["part_id"] = space.part_id;
  json["hand"] = space.hand;
  json["grasps"] = space.num_grasps;
  json["coverage"] = space.coverage;
  json["configurations_tried"] = space.configurations_tried;
  json["support_vectors"] = space.num_support_vectors;
  json["curve"] = Json::array();
  for (const LearningRound& round : space.curve) {
    Json entry;
    entry["samples"] = round.samples;
    entry["support_vectors"] = round.support_vectors;
    entry["balanced_accuracy"] = round.balanced_accuracy;
    entry["boundary_accuracy"] = round.boundary_accuracy;
    json["curve"].push_back(std::move(entry));
  }
  json["seconds"] = space.seconds;
  json["configuration_space_seconds"] = space.configuration_space_seconds;
  json["parameters"] = Parsed(space.parameters);
  json["provenance"]["engine_version"] = space.engine_version;
  json["provenance"]["parameters_hash"] = space.parameters_hash;
  json["provenance"]["seed"] = space.seed;
  json["created_at"] = space.created_at;
  return DumpJson(json);
}

std::string ToJson(const StoredJob& job) {
  Json json;
  json["id"] = job.id;
  json["kind"] = ToString(job.kind);
  json["state"] = ToString(job.state);
  json["progress"] = job.progress;
  json["stage"] = job.stage;
  json["eta_s"] = OrNull(job.eta_seconds);
  json["grasps_found"] = OrNull(job.grasps_found);
  json["result"] = EncodeJobResult(job);
  json["error"] = Encode(job.error);
  json["deadline_at"] =
      job.deadline ? Json(FormatTime(*job.deadline)) : Json(nullptr);
  json["created_at"] = job.created_at;
  json["started_at"] = OrNull(job.started_at);
  json["finished_at"] = OrNull(job.finished_at);
  return DumpJson(json);
}

std::string ToJson(const StoredBackup& backup) {
  Json json;
  json["name"] = backup.name;
  json["bytes"] = backup.bytes;
  json["sha256"] = backup.sha256;
  json["created_at"] = backup.created_at;
  return DumpJson(json);
}

std::string ToJson(const StoreCounts& counts) {
  Json json;
  json["categories"] = counts.categories;
  json["objects"] = counts.objects;
  json["parts"] = counts.parts;
  json["hands"] = counts.hands;
  json["grasp_spaces"] = counts.grasp_spaces;
  json["grasps"] = counts.grasps;
  json["transfers"] = counts.transfers;
  json["jobs_unfinished"] = counts.jobs_unfinished;
  return DumpJson(json);
}

std::string ToJson(const CheckReport& check) {
  Json json;
  json["sound"] = check.problems.empty();
  json["problems"] = check.problems;
  json["blobs_checked"] = check.blobs_checked;
  json["counts"] = Parsed(ToJson(check.counts));
  return DumpJson(json);
}

}  // namespace graspdb
