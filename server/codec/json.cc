#include "server/codec/json.h"

#include <cmath>

namespace graspdb {
namespace {

Error Malformed(const std::string& what, size_t byte) {
  return Error{ErrorCode::kInvalidArgument,
               "The JSON is not usable: " + what + " at byte " +
                   std::to_string(byte) + ".",
               "send one JSON value as RFC 8259 defines it"};
}

// Builds the value while the parser, which does not recurse, reads it.
class Builder : public nlohmann::json_sax<Json> {
 public:
  explicit Builder(const JsonLimits& limits) : limits_(limits) {}

  bool null() override { return Add(nullptr); }
  bool boolean(bool value) override { return Add(value); }
  bool number_integer(int64_t value) override { return Add(value); }
  bool number_unsigned(uint64_t value) override { return Add(value); }
  bool number_float(double value, const std::string&) override {
    if (!std::isfinite(value)) return Refuse("a number that is too large");
    return Add(value);
  }
  bool string(std::string& value) override { return Add(std::move(value)); }
  bool binary(Json::binary_t&) override { return Refuse("binary data"); }

  bool start_object(size_t) override { return Open(Json::object()); }
  bool start_array(size_t) override { return Open(Json::array()); }
  bool end_object() override { return Close(); }
  bool end_array() override { return Close(); }
  bool key(std::string& name) override {
    if (!open_.back().keys.insert(name).second) {
      return Refuse("a key that is there twice");
    }
    name_ = std::move(name);
    return true;
  }
  bool parse_error(size_t byte, const std::string&,
                   const nlohmann::detail::exception& exception) override {
    constexpr int kOutOfRange = 406;  // nlohmann's id for 1e400.
    fault_ =
        Malformed(exception.id == kOutOfRange ? "a number that is too large"
                                              : "something unexpected",
                  byte);
    return false;
  }

  const std::optional<Error>& fault() const { return fault_; }
  Json& root() { return root_; }

 private:
  struct Level {
    Json* value;
    std::set<std::string> keys;
  };

  bool Refuse(const std::string& what) {
    fault_ = Error{ErrorCode::kInvalidArgument,
                   "The JSON is not usable: it has " + what + ".",
                   "send one JSON value as RFC 8259 defines it"};
    return false;
  }
  // Where a new value goes. Values on the path to it never move.
  Json* Place(Json value) {
    if (++num_values_ > limits_.max_values) {
      fault_ = Error{ErrorCode::kTooLarge,
                     "The JSON has more than " +
                         std::to_string(limits_.max_values) + " values.",
                     "send less at once"};
      return nullptr;
    }
    if (open_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    Json& parent = *open_.back().value;
    if (parent.is_array()) {
      parent.push_back(std::move(value));
      return &parent.back();
    }
    // The base's function, since keys are known to differ.
    auto& members = parent.get_ref<Json::object_t&>();
    members.Json::object_t::Container::emplace_back(std::move(name_),
                                                    std::move(value));
    return &members.back().second;
  }
  bool Add(Json value) { return Place(std::move(value)) != nullptr; }
  bool Open(Json value) {
    if (static_cast<int>(open_.size()) == limits_.max_depth) {
      return Refuse("more than " + std::to_string(limits_.max_depth) +
                    " nested brackets");
    }
    Json* const place = Place(std::move(value));
    if (place != nullptr) open_.push_back({place, {}});
    return place != nullptr;
  }
  bool Close() {
    open_.pop_back();
    return true;
  }

  const JsonLimits limits_;
  size_t num_values_{0};
  Json root_;
  std::vector<Level> open_;
  std::string name_;
  std::optional<Error> fault_;
};

std::string TypeOf(const Json& value) {
  return std::string(value.is_null() ? "null" : value.type_name());
}

}  // namespace

Result<Json> ParseJson(std::string_view text, const JsonLimits& limits) {
  if (text.size() > limits.max_bytes) {
    return Error{ErrorCode::kTooLarge,
                 "The JSON has " + std::to_string(text.size()) +
                     " bytes; at most " + std::to_string(limits.max_bytes) +
                     " are read.",
                 "send less at once"};
  }
  Builder builder(limits);
  if (!Json::sax_parse(text.begin(), text.end(), &builder)) {
    return builder.fault().value_or(Malformed("something unexpected", 0));
  }
  return std::move(builder.root());
}

std::string DumpJson(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

JsonFields::JsonFields(const Json& object, std::string path)
    : object_(object), path_(std::move(path)) {
  if (!object.is_object()) {
    error_ = Error{ErrorCode::kInvalidArgument,
                   (path_.empty() ? "The JSON" : path_) +
                       " is not an object but " + TypeOf(object) + ".",
                   "", path_};
  }
}

bool JsonFields::Has(const std::string& name) const {
  return object_.is_object() && object_.contains(name);
}

const Json* JsonFields::Find(const std::string& name) {
  asked_.insert(name);
  if (failed() || !object_.contains(name)) return nullptr;
  return &object_[name];
}

const Json* JsonFields::Require(const std::string& name) {
  const Json* value = Find(name);
  if (value == nullptr && !failed()) {
    error_ = Error{ErrorCode::kInvalidArgument, PathOf(name) + " is missing.",
                   "", PathOf(name)};
  }
  return value;
}

void JsonFields::Read(const std::string& name, std::string& value) {
  const Json* json = Find(name);
  if (json == nullptr) return;
  if (!json->is_string()) return Fail(name, "text");
  value = json->get<std::string>();
}

void JsonFields::Read(const std::string& name, double& value) {
  const Json* json = Find(name);
  if (json == nullptr) return;
  if (!json->is_number()) return Fail(name, "a number");
  value = json->get<double>();
}

void JsonFields::Read(const std::string& name, bool& value) {
  const Json* json = Find(name);
  if (json == nullptr) return;
  if (!json->is_boolean()) return Fail(name, "true or false");
  value = json->get<bool>();
}

void JsonFields::Read(const std::string& name,
                      std::vector<std::string>& value) {
  const Json* json = Find(name);
  if (json == nullptr) return;
  if (!json->is_array()) return Fail(name, "a list of texts");
  std::vector<std::string> texts;
  for (const Json& item : *json) {
    if (!item.is_string()) return Fail(name, "a list of texts");
    texts.push_back(item.get<std::string>());
  }
  value = std::move(texts);
}

void JsonFields::Read(const std::string& name, Eigen::Vector3d& value) {
  const Json* json = Find(name);
  if (json == nullptr) return;
  const char* takes = "three numbers";
  if (!json->is_array() || json->size() != 3) return Fail(name, takes);
  for (size_t i = 0; i < 3; ++i) {
    const Json& item = (*json)[i];
    if (!item.is_number()) return Fail(name, takes);
    value[static_cast<Eigen::Index>(i)] = item.get<double>();
  }
}

void JsonFields::ReadInteger(const std::string& name, int& value, int least,
                             int most) {
  const Json* json = Find(name);
  if (json == nullptr) return;
  // As doubles, since a number beyond 64 bits must not wrap around.
  const double number = json->is_number() ? json->get<double>() : NAN;
  if (!(number >= least && number <= most) || number != std::floor(number)) {
    return Fail(name, "a whole number from " + std::to_string(least) + " to " +
                          std::to_string(most));
  }
  value = static_cast<int>(number);
}

void JsonFields::ReadSeed(const std::string& name, uint64_t& value) {
  const Json* json = Find(name);
  if (json == nullptr) return;
  if (!json->is_number_unsigned()) {
    return Fail(name, "a whole number from 0 to 18446744073709551615");
  }
  value = json->get<uint64_t>();
}

void JsonFields::RequireText(const std::string& name, std::string& value) {
  if (Require(name) == nullptr) return;
  Read(name, value);
  if (!failed() && value.empty()) Fail(name, "text that is not empty");
}

std::string JsonFields::PathOf(const std::string& name) const {
  return path_.empty() ? name : path_ + "." + name;
}

void JsonFields::Fail(const std::string& name, const std::string& takes) {
  Fail(Error{ErrorCode::kInvalidArgument,
             PathOf(name) + " must be " + takes + ".", "", PathOf(name)});
}

void JsonFields::Fail(const Error& error) {
  if (!error_) error_ = error;
}

Result<void> JsonFields::Finish() const {
  if (error_) return *error_;
  for (const auto& [name, value] : object_.items()) {
    if (asked_.contains(name)) continue;
    std::string known;
    for (const std::string& asked : asked_) {
      known += (known.empty() ? "" : ", ") + asked;
    }
    return Error{ErrorCode::kInvalidArgument,
                 PathOf(name) + " is not a known field.", "known: " + known,
                 PathOf(name)};
  }
  return {};
}

}  // namespace graspdb
