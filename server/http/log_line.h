#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace graspdb {

/** One line of the log, without its line break: `time=… level=… event=…` and
 the fields, in order. A value with other characters than those of words,
 numbers, paths and times stands in quotes, quotes, backslashes and
 what is not printable ASCII as `?`;
 long ones are cut.
 @param level  info or error. */
std::string MakeLogLine(
    std::string_view level, std::string_view event,
    const std::vector<std::pair<std::string_view, std::string>>& fields = {});

}  // namespace graspdb
