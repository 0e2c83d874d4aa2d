#include "server/codec/order_json.h"

#include <algorithm>
#include <climits>
#include <utility>

#include "server/codec/input_json.h"
#include "server/codec/json.h"
#include "server/codec/label_limits.h"
#include "server/codec/parameters_json.h"

namespace graspdb {
namespace {

void ReadParameters(JsonFields& fields, Parameters& parameters) {
  const Json* json = fields.Find("parameters");
  if (json == nullptr) return;
  auto read = ParametersFromJson(DumpJson(*json), parameters);
  if (read) {
    parameters = *read;
  } else {
    Error error = read.error();
    error.field = fields.PathOf("parameters") + "." + error.field;
    fields.Fail(error);
  }
}

GraspStage ReadStage(const std::string& text, JsonFields& fields) {
  const auto stage = ParseGraspStage(text);
  if (stage) return *stage;
  fields.Fail(stage.error());
  return GraspStage::kLearned;
}

// A label per face is the larger part of some orders.
std::string EncodeLabels(const ImportOrder& order) {
  if (order.face_labels.empty()) return "";
  Json json;
  json["face_labels"] = order.face_labels;
  return DumpJson(json);
}

Json Encode(const ImportOrder& order) {
  Json json;
  json["file_name"] = order.file_name;
  json["format"] = order.format;
  json["units"] = order.units;
  json["role"] = ToString(order.role);
  json["category"] = order.category;
  json["name"] = order.name;
  json["face_labels"] = Json::array();
  json["seed"] = order.seed;
  json["learn"] = order.learn;
  if (!order.face_labels.empty()) {
    json["labels_bytes"] = EncodeLabels(order).size();
  }
  return json;
}

ImportOrder ReadImportOrder(JsonFields& fields, std::string payload) {
  ImportOrder order;
  std::string role = ToString(order.role);
  int labels_bytes = 0;
  fields.Read("file_name", order.file_name);
  fields.Read("format", order.format);
  fields.Read("units", order.units);
  fields.Read("role", role);
  fields.Read("category", order.category);
  fields.Read("name", order.name);
  fields.Read("face_labels", order.face_labels);  // There in older jobs.
  fields.ReadInteger("labels_bytes", labels_bytes, 0,
                     static_cast<int>(std::min<size_t>(
                         payload.size(), kLabelLimits.max_bytes)));
  fields.ReadSeed("seed", order.seed);
  fields.Read("learn", order.learn);
  if (labels_bytes > 0) {
    const auto end = static_cast<size_t>(labels_bytes);
    auto labels = FaceLabelsFromJson(payload.substr(0, end));
    if (labels) {
      order.face_labels = std::move(*labels);
    } else {
      fields.Fail(labels.error());
    }
    payload.erase(0, end);
  }
  order.bytes = std::move(payload);
  const auto parsed = ParseObjectRole(role);
  if (parsed) {
    order.role = *parsed;
  } else {
    fields.Fail(parsed.error());
  }
  return order;
}

SegmentOrder ReadSegmentOrder(JsonFields& fields) {
  SegmentOrder order;
  fields.Read("category", order.category);
  fields.ReadSeed("seed", order.seed);
  order.face_labels = ReadFaceLabels(fields);
  if (const Json* settings = fields.Find("settings")) {
    order.settings = DumpJson(*settings);
    const auto read =
        SegmentationFromJson(order.settings, SegmentationParameters());
    if (!read) fields.Fail(read.error());
  }
  return order;
}

LearnOrder ReadLearnOrder(JsonFields& fields) {
  LearnOrder order;
  fields.Read("parts", order.part_labels);
  if (order.part_labels.size() > kMostParts) {
    fields.Fail("parts", "at most 64 labels");
  }
  fields.Read("hands", order.hands);
  ReadParameters(fields, order.parameters);
  fields.ReadSeed("seed", order.seed);
  return order;
}

VerifyOrder ReadVerifyOrder(JsonFields& fields) {
  VerifyOrder order;
  GraspQuery& query = order.query;
  fields.Read("category", query.category);
  fields.Read("parts", query.part_labels);
  if (query.part_labels.size() > kMostParts) {
    fields.Fail("parts", "at most 64 labels");
  }
  fields.Read("hand", query.hand);
  fields.Read("object", query.object_id);
  fields.Read("grasp_space", query.grasp_space_id);
  fields.Read("transfer", query.transfer_id);
  if (fields.Has("stage")) {
    std::string stage;
    fields.RequireText("stage", stage);
    query.stage = ReadStage(stage, fields);
  }
  order.limit = 1000;
  fields.ReadInteger("limit", order.limit, 1, kMostVerified);
  fields.Read("again", order.again);
  return order;
}

TransferOrder ReadTransferOrder(JsonFields& fields, std::string payload) {
  TransferOrder order;
  if (const Json* mesh = fields.Find("mesh")) {
    JsonFields inner(*mesh, "mesh");
    order.mesh = ReadImportOrder(inner, std::move(payload));
    if (const auto read = inner.Finish(); !read) fields.Fail(read.error());
  }
  std::string stage = ToString(order.stage);
  fields.Read("object", order.object_id);
  fields.Read("category", order.category);
  fields.Read("parts", order.part_labels);
  fields.Read("task", order.task);
  fields.Read("hand", order.hand);
  if (const Json* count = fields.Find("count");
      count != nullptr && !count->is_null()) {
    int number = 0;
    fields.ReadInteger("count", number, 1, INT_MAX);
    order.count = number;
  }
  fields.Read("exhaustive", order.exhaustive);
  fields.ReadInteger("sources", order.sources, 1, INT_MAX);
  fields.Read("stage", stage);
  order.stage = ReadStage(stage, fields);
  ReadParameters(fields, order.parameters);
  fields.ReadSeed("seed", order.seed);
  return order;
}

// The whole of a text: read() takes the members that it knows.
template <class F>
auto ReadOrder(const std::string& text, const JsonLimits& limits, F&& read)
    -> Result<decltype(read(std::declval<JsonFields&>()))> {
  GRASPDB_TRY(json, ParseJson(text, limits));
  JsonFields fields(json, "");
  auto order = read(fields);
  GRASPDB_TRY_VOID(fields.Finish());
  return order;
}

}  // namespace

Result<SegmentOrder> SegmentOrderFromJson(const std::string& text) {
  return ReadOrder(text, kLabelLimits, ReadSegmentOrder);
}

Result<VerifyOrder> VerifyOrderFromJson(const std::string& text) {
  return ReadOrder(text, JsonLimits(), ReadVerifyOrder);
}

Result<LearnOrder> LearnOrderFromJson(const std::string& text) {
  return ReadOrder(text, JsonLimits(), ReadLearnOrder);
}

std::string ToJson(const ImportOrder& order) { return DumpJson(Encode(order)); }

std::string MakePayload(const ImportOrder& order) {
  return EncodeLabels(order) + order.bytes;
}

std::string ToJson(const SegmentOrder& order) {
  Json json;
  json["object"] = order.object_id;
  json["category"] = order.category;
  if (!order.settings.empty()) json["settings"] = Json::parse(order.settings);
  json["face_labels"] = order.face_labels;
  json["seed"] = order.seed;
  json["cascade"] = order.cascade;
  return DumpJson(json);
}

std::string ToJson(const VerifyOrder& order) {
  const GraspQuery& query = order.query;
  Json json;
  json["category"] = query.category;
  json["parts"] = query.part_labels;
  json["hand"] = query.hand;
  json["object"] = query.object_id;
  json["grasp_space"] = query.grasp_space_id;
  json["transfer"] = query.transfer_id;
  if (query.stage) json["stage"] = ToString(*query.stage);
  json["limit"] = order.limit;
  json["again"] = order.again;
  return DumpJson(json);
}

std::string ToJson(const LearnOrder& order) {
  Json json;
  json["object"] = order.object_id;
  json["parts"] = order.part_labels;
  json["hands"] = order.hands;
  json["parameters"] = Json::parse(ParametersToJson(order.parameters));
  json["seed"] = order.seed;
  return DumpJson(json);
}

std::string ToJson(const TransferOrder& order) {
  Json json;
  json["mesh"] = Encode(order.mesh);
  json["object"] = order.object_id;
  json["category"] = order.category;
  json["parts"] = order.part_labels;
  json["task"] = order.task;
  json["hand"] = order.hand;
  json["count"] = order.count ? Json(*order.count) : Json(nullptr);
  json["exhaustive"] = order.exhaustive;
  json["sources"] = order.sources;
  json["stage"] = ToString(order.stage);
  json["parameters"] = Json::parse(ParametersToJson(order.parameters));
  json["seed"] = order.seed;
  return DumpJson(json);
}

Result<ImportOrder> StoredImportOrderFromJson(const std::string& text,
                                              std::string payload) {
  return ReadOrder(text, kLabelLimits, [&](JsonFields& fields) {
    return ReadImportOrder(fields, std::move(payload));
  });
}

Result<SegmentOrder> StoredSegmentOrderFromJson(const std::string& text) {
  return ReadOrder(text, kLabelLimits, [](JsonFields& fields) {
    SegmentOrder order = ReadSegmentOrder(fields);
    fields.RequireText("object", order.object_id);
    fields.Read("cascade", order.cascade);
    return order;
  });
}

Result<LearnOrder> StoredLearnOrderFromJson(const std::string& text) {
  return ReadOrder(text, kLabelLimits, [](JsonFields& fields) {
    LearnOrder order = ReadLearnOrder(fields);
    fields.RequireText("object", order.object_id);
    return order;
  });
}

Result<TransferOrder> StoredTransferOrderFromJson(const std::string& text,
                                                  std::string payload) {
  return ReadOrder(text, kLabelLimits, [&](JsonFields& fields) {
    return ReadTransferOrder(fields, std::move(payload));
  });
}

}  // namespace graspdb
