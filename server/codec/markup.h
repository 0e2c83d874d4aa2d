#pragma once

#include <string>

namespace graspdb {

/** `text` where HTML and XML take plain text, or a quoted attribute. */
std::string EscapeMarkup(const std::string& text);

}  // namespace graspdb
