#include "server/codec/record_json.h"

#include <Eigen/Geometry>

#include "server/codec/json.h"
#include "server/codec/parameters_json.h"

namespace graspdb {
namespace {

// Stored text that is JSON already, made by this program.
Json Parsed(const std::string& text) { return Json::parse(text); }

// Absent values are null, never empty text.
Json OrNull(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

template <class T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json Encode(const Eigen::Vector3d& vector) {
  return Json::array({vector.x(), vector.y(), vector.z()});
}

// The quaternion of the two that has w >= 0.
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

Json EncodeJoints(const HandModel& hand, const Eigen::VectorXd& q) {
  GRASPDB_EXPECTS(q.size() == hand.num_joints());
  Json json = Json::object();
  for (int i = 0; i < hand.num_joints(); ++i) {
    json[hand.joints()[i].name] = q[i];
  }
  return json;
}

Json EncodeActuators(const HandModel& hand, const Eigen::VectorXd& q) {
  const Eigen::VectorXd positions = hand.CalcActuators(q);
  Json json = Json::object();
  for (int i = 0; i < hand.num_actuators(); ++i) {
    json[hand.actuators()[i].name] = positions[i];
  }
  return json;
}

Json EncodePregrasp(const HandModel& hand, const Grasp& grasp) {
  RigidTransform X_OH = grasp.configuration.X_OH;
  X_OH.translation -= grasp.retreat * grasp.approach_O;
  Json json;
  json["X_OH"] = Encode(X_OH);
  json["joints"] = EncodeJoints(hand, grasp.q_pregrasp);
  json["approach"] = Encode(grasp.approach_O);
  json["distance"] = grasp.retreat;
  return json;
}

Json EncodeQuality(const StoredGrasp& grasp) {
  const bool learned = grasp.stage == GraspStage::kLearned;
  Json json;
  json["epsilon"] = grasp.grasp.quality.epsilon;
  json["volume"] = grasp.grasp.quality.volume;
  json["hybrid"] = grasp.grasp.quality.hybrid;
  json["example_epsilon"] = grasp.example_epsilon;
  json["open_close_epsilon"] =
      learned ? Json(nullptr) : Json(grasp.open_close_epsilon);
  json["robust"] = OrNull(grasp.robust);
  json["physical"] = OrNull(grasp.physical);
  return json;
}

Json EncodeContacts(const StoredGrasp& grasp, const HandModel& hand) {
  Json json = Json::array();
  for (size_t i = 0; i < grasp.grasp.contacts.size(); ++i) {
    const Contact& contact = grasp.grasp.contacts[i];
    GRASPDB_EXPECTS(contact.link < hand.num_links());
    Json entry;
    entry["link"] = hand.links()[contact.link].name;
    entry["p_O"] = Encode(contact.p_O);
    entry["n_O"] = Encode(contact.nhat_O);
    const bool mapped = i < grasp.targets_O.size() && grasp.targets_O[i];
    entry["mapped_p_O"] = mapped ? Encode(*grasp.targets_O[i]) : Json(nullptr);
    entry["seen"] = contact.seen;
    json.push_back(std::move(entry));
  }
  return json;
}

Json EncodeProvenance(const StoredGrasp& grasp) {
  Json json;
  json["engine_version"] = grasp.engine_version;
  json["parameters_hash"] = grasp.parameters_hash;
  json["seed"] = grasp.seed;
  json["grasp_space"] = grasp.grasp_space_id;
  json["transfer"] = OrNull(grasp.transfer_id);
  json["source_grasp"] = OrNull(grasp.source_grasp_id);
  return json;
}

Json Encode(const StoredGrasp& grasp, const HandModel& hand) {
  GRASPDB_EXPECTS(hand.name() == grasp.hand);
  const HandConfiguration& configuration = grasp.grasp.configuration;
  Json json;
  json["id"] = grasp.id;
  json["object"] = grasp.object_id;
  json["category"] = grasp.category;
  json["part"] = grasp.part_label;
  json["part_id"] = grasp.part_id;
  json["hand"] = grasp.hand;
  json["stage"] = ToString(grasp.stage);
  json["X_OH"] = Encode(configuration.X_OH);
  json["joints"] = EncodeJoints(hand, configuration.q);
  json["actuators"] = EncodeActuators(hand, configuration.q);
  json["pregrasp"] = EncodePregrasp(hand, grasp.grasp);
  json["quality"] = EncodeQuality(grasp);
  json["contacts"] = EncodeContacts(grasp, hand);
  json["penetration_m"] = grasp.penetration;
  json["clearances"] = Json::object();
  for (const auto& [label, distance] : grasp.clearances) {
    json["clearances"][label] = distance;
  }
  json["provenance"] = EncodeProvenance(grasp);
  return json;
}

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

// Which stage a source grasp failed at and why; empty reason: it did not.
std::pair<const char*, const char*> FindFailure(const StoredAttempt& attempt,
                                                GraspStage wanted) {
  if (attempt.transfer != TransferOutcome::kSucceeded) {
    return {"transfer", ToString(attempt.transfer)};
  }
  if (wanted == GraspStage::kAssembly &&
      attempt.assembly != TransferOutcome::kSucceeded) {
    return {"assembly", ToString(attempt.assembly)};
  }
  return {"", ""};
}

// How many source grasps were tried, transferred, assembled; how many the
// open-close baseline holds at the stage asked for.
Json EncodeSummary(const StoredTransfer& transfer) {
  const bool assembly = transfer.stage == GraspStage::kAssembly;
  int transferred = 0;
  int assembled = 0;
  int baseline = 0;
  for (const StoredAttempt& attempt : transfer.attempts) {
    const bool kept = attempt.transfer == TransferOutcome::kSucceeded;
    transferred += kept;
    assembled += kept && attempt.assembly == TransferOutcome::kSucceeded;
    baseline += (assembly ? attempt.open_close_epsilon_whole
                          : attempt.open_close_epsilon_part) > 0.0;
  }
  Json json;
  json["attempted"] = transfer.attempts.size();
  json["transferred"] = transferred;
  json["assembled"] = assembly ? Json(assembled) : Json(nullptr);
  json["baseline_open_close"] = baseline;
  return json;
}

Json EncodeRejected(const StoredTransfer& transfer) {
  Json json = Json::array();
  for (const StoredAttempt& attempt : transfer.attempts) {
    const auto [stage, reason] = FindFailure(attempt, transfer.stage);
    if (*reason == '\0') continue;
    Json entry;
    entry["source_grasp"] = attempt.source_grasp_id;
    entry["part"] = attempt.part_label;
    entry["stage"] = stage;
    entry["reason"] = reason;
    json.push_back(std::move(entry));
  }
  return json;
}

Json Encode(const StoredContactMap& map) {
  Json json;
  json["id"] = map.id;
  json["part"] = map.part_label;
  json["example_part"] = map.example_part_id;
  json["novel_part"] = map.novel_part_id;
  json["X_NE"] = Encode(map.alignment.X_NE);
  json["scale"] = map.alignment.scale;
  json["residual"] = map.alignment.residual;
  json["mapped_share"] = map.alignment.mapped_share;
  return json;
}

Json Encode(const StoredAttempt& attempt, GraspStage wanted) {
  const bool assembly = wanted == GraspStage::kAssembly;
  Json json;
  json["source_grasp"] = attempt.source_grasp_id;
  json["part"] = attempt.part_label;
  json["part_id"] = attempt.part_id;
  json["transfer"] = ToString(attempt.transfer);
  json["assembly"] =
      assembly ? Json(ToString(attempt.assembly)) : Json(nullptr);
  json["transferred_grasp"] = OrNull(attempt.transferred_grasp_id);
  json["assembled_grasp"] = OrNull(attempt.assembled_grasp_id);
  json["example_epsilon"] = attempt.example_epsilon;
  json["example_epsilon_whole"] = attempt.example_epsilon_whole;
  json["open_close_epsilon_part"] = attempt.open_close_epsilon_part;
  json["open_close_epsilon_whole"] = attempt.open_close_epsilon_whole;
  return json;
}

Json EncodeJobResult(const StoredJob& job) {
  if (job.state != JobState::kSucceeded) return nullptr;
  const bool transfer = job.kind == JobKind::kTransfer;
  Json json;
  json[transfer ? "transfer" : "object"] = job.result_id;
  json["href"] = (transfer ? "/v1/transfers/" : "/v1/objects/") + job.result_id;
  return json;
}

Json Encode(const std::optional<Error>& error) {
  if (!error) return nullptr;
  Json json;
  json["code"] = ToString(error->code);
  json["detail"] = error->code == ErrorCode::kInternal
                       ? "The server made a mistake."
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
  json["parameters"] = Parsed(space.parameters);
  json["provenance"]["engine_version"] = space.engine_version;
  json["provenance"]["parameters_hash"] = space.parameters_hash;
  json["provenance"]["seed"] = space.seed;
  json["created_at"] = space.created_at;
  return DumpJson(json);
}

std::string ToJson(const StoredGrasp& grasp, const HandModel& hand) {
  return DumpJson(Encode(grasp, hand));
}

std::string ToJson(const StoredJob& job) {
  Json json;
  json["id"] = job.id;
  json["kind"] = ToString(job.kind);
  json["state"] = ToString(job.state);
  json["progress"] = job.progress;
  json["stage"] = job.stage;
  json["eta_s"] = OrNull(job.eta_seconds);
  json["result"] = EncodeJobResult(job);
  json["error"] = Encode(job.error);
  json["created_at"] = job.created_at;
  json["started_at"] = OrNull(job.started_at);
  json["finished_at"] = OrNull(job.finished_at);
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

std::string ToJson(const TransferAnswer& answer) {
  const StoredTransfer& transfer = answer.transfer;
  Json json;
  json["transfer_id"] = transfer.id;
  json["object"]["id"] = answer.object.id;
  json["object"]["sha256"] = answer.object.sha256;
  json["object"]["triangles"] = answer.object.num_triangles;
  json["object"]["repairs"] = answer.object.repairs;
  json["object"]["parts"] = Json::array();
  for (const StoredPart& part : answer.parts) {
    json["object"]["parts"].push_back({{"id", part.id}, {"label", part.label}});
  }
  json["example"]["id"] = transfer.example_id;
  json["example"]["category"] = transfer.category;
  json["example"]["similarity"] = transfer.similarity;
  json["summary"] = EncodeSummary(transfer);
  json["complete"] = transfer.complete;
  json["grasps"] = Json::array();
  for (const StoredGrasp& grasp : answer.grasps) {
    json["grasps"].push_back(Encode(grasp, *answer.hand));
  }
  json["rejected"] = EncodeRejected(transfer);
  json["warnings"] = transfer.warnings;
  return DumpJson(json);
}

std::string ToJson(const StoredTransfer& transfer) {
  Json json;
  json["id"] = transfer.id;
  json["object"] = transfer.object_id;
  json["example"] = transfer.example_id;
  json["category"] = transfer.category;
  json["hand"] = transfer.hand;
  json["stage"] = ToString(transfer.stage);
  json["parts"] = transfer.part_labels;
  json["keep_free"] = transfer.keep_free;
  json["sources_per_part"] = transfer.sources_per_part;
  json["similarity"] = transfer.similarity;
  json["complete"] = transfer.complete;
  json["summary"] = EncodeSummary(transfer);
  json["contact_maps"] = Json::array();
  for (const StoredContactMap& map : transfer.contact_maps) {
    json["contact_maps"].push_back(Encode(map));
  }
  json["attempts"] = Json::array();
  for (const StoredAttempt& attempt : transfer.attempts) {
    json["attempts"].push_back(Encode(attempt, transfer.stage));
  }
  json["warnings"] = transfer.warnings;
  json["seconds"] = Json::object();
  for (const auto& [stage, seconds] : transfer.seconds) {
    json["seconds"][stage] = seconds;
  }
  json["parameters"] = Parsed(transfer.parameters);
  json["provenance"]["engine_version"] = transfer.engine_version;
  json["provenance"]["parameters_hash"] = transfer.parameters_hash;
  json["provenance"]["seed"] = transfer.seed;
  json["created_at"] = transfer.created_at;
  return DumpJson(json);
}

}  // namespace graspdb
