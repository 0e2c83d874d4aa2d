#pragma once

#include <string_view>

namespace graspdb {

/** True when `text` is well-formed UTF-8 (RFC 3629). */
bool IsUtf8(std::string_view text);

}  // namespace graspdb
