#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/** @file
 Cutting text into lines and words, for the readers of text formats. */

namespace graspdb {

std::string ToLower(std::string_view text);

/** The text without spaces, tabs and carriage returns around it. */
std::string_view Trim(std::string_view text);

/** Cuts the next line, without its end, off the text. */
std::string_view TakeLine(std::string_view& text);

/** Cuts the next word off the text; empty at the end. */
std::string_view TakeWord(std::string_view& text);

/** The whole word as a number, a dot before its decimals whatever the locale;
 "nan" and "inf" are numbers, too. */
std::optional<double> ParseNumber(std::string_view word);
bool ParseInteger(std::string_view word, int64_t& number);

}  // namespace graspdb
