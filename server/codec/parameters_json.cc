#include "server/codec/parameters_json.h"

#include <cmath>

#include <fmt/format.h>

#include "server/codec/json.h"

namespace graspdb {
namespace {

// A section's fields as a JSON object.
class ToJsonVisitor {
 public:
  template <class Section>
  void operator()(const char* name, const Section& section) {
    ToJsonVisitor inner;
    Section::Visit(section, inner);
    json_[name] = std::move(inner.json_);
  }
  template <class T>
  void operator()(const char* name, const T& value, const ParameterInfo&) {
    json_[name] = value;
  }
  const Json& json() const { return json_; }

 private:
  Json json_ = Json::object();
};

// Takes the fields that a JSON object has, checking types and ranges.
class FromJsonVisitor {
 public:
  explicit FromJsonVisitor(JsonFields& fields) : fields_(fields) {}

  template <class Section>
  void operator()(const char* name, Section& section) {
    const Json* json = fields_.Find(name);
    if (json == nullptr) return;
    JsonFields inner(*json, fields_.PathOf(name));
    FromJsonVisitor visitor(inner);
    Section::Visit(section, visitor);
    if (const auto finished = inner.Finish(); !finished) {
      fields_.Fail(finished.error());
    }
  }
  void operator()(const char* name, bool& value, const ParameterInfo&) {
    fields_.Read(name, value);
  }
  void operator()(const char* name, double& value, const ParameterInfo& info) {
    double number = value;
    fields_.Read(name, number);
    if (Check(name, number, info)) value = number;
  }
  void operator()(const char* name, int& value, const ParameterInfo& info) {
    double number = value;
    fields_.Read(name, number);
    if (number != std::floor(number)) {
      fields_.Fail(name, "a whole number");
    } else if (Check(name, number, info)) {
      value = static_cast<int>(number);
    }
  }

 private:
  bool Check(const char* name, double number, const ParameterInfo& info) {
    if (number >= info.minimum && number <= info.maximum) return true;
    fields_.Fail(name, fmt::format("from {} to {} {}, not {}", info.minimum,
                                   info.maximum, info.unit, number));
    return false;
  }

  JsonFields& fields_;
};

Json MakeJson(const Parameters& parameters) {
  ToJsonVisitor visitor;
  Parameters::Visit(parameters, visitor);
  return visitor.json();
}

}  // namespace

std::string ParametersToJson(const Parameters& parameters) {
  return DumpJson(MakeJson(parameters));
}

Result<Parameters> ParametersFromJson(const std::string& text,
                                      const Parameters& base) {
  GRASPDB_TRY(json, ParseJson(text));
  JsonFields fields(json, "");
  Parameters parameters = base;
  if (fields.Has("preset")) {
    std::string preset;
    fields.Read("preset", preset);
    if (preset == "default") {
      parameters = MakeDefaultParameters();
    } else if (preset == "paper") {
      parameters = MakePaperParameters();
    } else {
      fields.Fail("preset", "default or paper");
    }
  }
  FromJsonVisitor visitor(fields);
  Parameters::Visit(parameters, visitor);
  GRASPDB_TRY_VOID(fields.Finish());
  return parameters;
}

Result<SegmentationParameters> SegmentationFromJson(
    const std::string& text, const SegmentationParameters& base) {
  GRASPDB_TRY(json, ParseJson(text));
  JsonFields fields(json, "segmentation");
  SegmentationParameters parameters = base;
  FromJsonVisitor visitor(fields);
  SegmentationParameters::Visit(parameters, visitor);
  GRASPDB_TRY_VOID(fields.Finish());
  return parameters;
}

std::string SegmentationToJson(const SegmentationParameters& parameters) {
  ToJsonVisitor visitor;
  SegmentationParameters::Visit(parameters, visitor);
  return DumpJson(visitor.json());
}

std::string DescribeParameters() {
  const Parameters defaults = MakeDefaultParameters();
  Json answer;
  answer["items"] = Json::array();
  VisitFields(defaults, [&](const std::string& path, auto value,
                            const ParameterInfo& info) {
    Json entry;
    entry["name"] = path;
    entry["value"] = value;
    entry["unit"] = info.unit;
    entry["minimum"] = info.minimum;
    entry["maximum"] = info.maximum;
    entry["source"] = info.source;
    answer["items"].push_back(std::move(entry));
  });
  answer["presets"]["default"] = MakeJson(defaults);
  answer["presets"]["paper"] = MakeJson(MakePaperParameters());
  answer["next_cursor"] = nullptr;
  return DumpJson(answer);
}

}  // namespace graspdb
