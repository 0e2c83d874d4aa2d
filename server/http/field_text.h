#pragma once

#include <string>
#include <string_view>

namespace graspdb {

/** The text of a header field without the spaces and tabs around it. */
std::string_view TrimBlanks(std::string_view text);

/** The names of header fields, and some values, count for the same in any case.
 ASCII only. */
std::string ToLowerAscii(std::string_view text);

}  // namespace graspdb
