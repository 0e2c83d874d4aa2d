#include "engine/base/contract.h"
#include "server/codec/encode.h"
#include "server/codec/record_json.h"

namespace graspdb {
namespace {

using graspdb::Encode;

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
  json["grip"] = OrNull(grasp.grip);
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

Json EncodeOverview(const StoredTransfer& transfer) {
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
  json["enough"] = OrNull(transfer.enough);
  json["summary"] = EncodeSummary(transfer);
  json["warnings"] = transfer.warnings;
  json["seconds"] = Json::object();
  for (const auto& [stage, seconds] : transfer.seconds) {
    json["seconds"][stage] = seconds;
  }
  json["provenance"]["engine_version"] = transfer.engine_version;
  json["provenance"]["parameters_hash"] = transfer.parameters_hash;
  json["provenance"]["seed"] = transfer.seed;
  json["created_at"] = transfer.created_at;
  return json;
}

}  // namespace

std::string ToJson(const StoredGrasp& grasp, const HandModel& hand) {
  return DumpJson(Encode(grasp, hand));
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
  json["enough"] = OrNull(transfer.enough);
  json["grasps"] = Json::array();
  for (const StoredGrasp& grasp : answer.grasps) {
    json["grasps"].push_back(Encode(grasp, *answer.hand));
  }
  json["rejected"] = EncodeRejected(transfer);
  json["warnings"] = transfer.warnings;
  return DumpJson(json);
}

std::string ToJson(const StoredTransfer& transfer) {
  Json json = EncodeOverview(transfer);
  json["contact_maps"] = Json::array();
  for (const StoredContactMap& map : transfer.contact_maps) {
    json["contact_maps"].push_back(Encode(map));
  }
  json["attempts"] = Json::array();
  for (const StoredAttempt& attempt : transfer.attempts) {
    json["attempts"].push_back(Encode(attempt, transfer.stage));
  }
  json["parameters"] = Parsed(transfer.parameters);
  return DumpJson(json);
}

std::string ToSummaryJson(const StoredTransfer& transfer) {
  return DumpJson(EncodeOverview(transfer));
}

}  // namespace graspdb
