#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "engine/base/result.h"

namespace graspdb {

/** Keys keep their order, so that the same value gives the same bytes. */
using Json = nlohmann::ordered_json;

struct JsonLimits {
  size_t max_bytes{1 << 20};
  int max_depth{64};
  size_t max_values{100'000};  ///< At all depths: "[]," takes fifty bytes.
};

/** The only way in for JSON that others wrote. Refuses what RFC 8259 does not
 allow and what is dangerous: more than max_depth nested brackets, duplicate
 keys, numbers that are not finite doubles (1e400, NaN), text that is not UTF-8,
 anything after the value.
 @retval kInvalidArgument saying what is wrong and at which byte.
 @retval kTooLarge beyond max_bytes, before anything is parsed, or beyond
   max_values. */
Result<Json> ParseJson(std::string_view text, const JsonLimits& limits = {});

/** Reads the members of one object, each by name and type. The first fault is
 kept and told by Finish(); reads after it change nothing. Messages name the
 field by its whole path ("segmentation.samples"). */
class JsonFields {
 public:
  /** @param path  Where the object stands, for messages; "" for the whole. */
  JsonFields(const Json& object, std::string path);

  bool Has(const std::string& name) const;
  /** The member as it is, or null when it is absent. */
  const Json* Find(const std::string& name);
  /** The same, its absence being a fault. */
  const Json* Require(const std::string& name);

  // An absent member leaves the value as it is.
  void Read(const std::string& name, std::string& value);
  void Read(const std::string& name, double& value);
  void Read(const std::string& name, bool& value);
  void Read(const std::string& name, std::vector<std::string>& value);
  void Read(const std::string& name, Eigen::Vector3d& value);
  /** Whole numbers from `least` to `most`. */
  void ReadInteger(const std::string& name, int& value, int least, int most);
  void ReadSeed(const std::string& name, uint64_t& value);
  /** Text that must be there and not be empty. */
  void RequireText(const std::string& name, std::string& value);

  /** The path of a member. */
  std::string PathOf(const std::string& name) const;
  /** Tells of a fault of a member. */
  void Fail(const std::string& name, const std::string& takes);
  /** Takes over the fault of a value that was read elsewhere. */
  void Fail(const Error& error);
  bool failed() const { return error_.has_value(); }

  /** @retval kInvalidArgument for the first fault, or the first member that
   nothing asked for. */
  Result<void> Finish() const;

 private:
  const Json& object_;
  std::string path_;
  std::set<std::string> asked_;
  std::optional<Error> error_;
};

/** The bytes of a value without blanks; text that is not UTF-8 is mended. */
std::string DumpJson(const Json& json);

}  // namespace graspdb
