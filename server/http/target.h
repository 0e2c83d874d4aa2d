#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/base/result.h"
#include "server/http/message.h"

namespace graspdb {

/** A request target such as "/v1/parts/a%20b?limit=3", taken apart. */
struct Target {
  std::vector<std::string> segments;  ///< Of the path, decoded; none for "/".
  TextPairs query;                    ///< Decoded, in order of appearance.

  bool operator==(const Target&) const = default;
};

/** Percent-decodes; with `plus_is_space`, "+" is a space, as in forms.
 @retval kInvalidArgument for a broken escape, NUL, or bytes that are no
 UTF-8. */
Result<std::string> DecodePercent(std::string_view text, bool plus_is_space);

/** Percent-encodes all but RFC 3986's unreserved characters. */
std::string EncodePercent(std::string_view text);

/** Splits and decodes a request target in origin form. A "/" that arrives
 encoded stays inside its segment; empty segments are kept, so that "//" and a
 trailing "/" name nothing.
 @retval kInvalidArgument as for DecodePercent. */
Result<Target> ParseTarget(std::string_view target);

}  // namespace graspdb
