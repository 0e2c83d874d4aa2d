#include "server/http/query.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace graspdb {
namespace {

/** The whole of `text` as a number, or nothing. */
template <typename T>
std::optional<T> Parse(const std::string& text) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

}  // namespace

const std::string* QueryReader::Find(const std::string& name) {
  known_.insert(name);
  const std::string* value = nullptr;
  for (const auto& [key, text] : query_) {
    if (key != name) continue;
    if (value != nullptr && !error_) {
      error_ = Error{ErrorCode::kInvalidArgument,
                     fmt::format("{} is given more than once.", name),
                     "Give each parameter once.", name};
    }
    value = &text;
  }
  return error_ ? nullptr : value;
}

void QueryReader::Refuse(const std::string& name, const std::string& value,
                         const std::string& takes) {
  constexpr size_t kShown = 64;
  std::string shown = value.substr(0, kShown);
  if (value.size() > kShown) shown += "...";
  error_ = Error{ErrorCode::kInvalidArgument,
                 fmt::format("{} takes {}, not \"{}\".", name, takes, shown),
                 "", name};
}

std::optional<std::string> QueryReader::Text(const std::string& name,
                                             size_t most) {
  const std::string* value = Find(name);
  if (value == nullptr) return std::nullopt;
  if (value->empty() || value->size() > most) {
    Refuse(name, *value, fmt::format("a text of 1 to {} bytes", most));
    return std::nullopt;
  }
  return *value;
}

std::optional<int64_t> QueryReader::Integer(const std::string& name,
                                            int64_t least, int64_t most) {
  const std::string* value = Find(name);
  if (value == nullptr) return std::nullopt;
  const auto number = Parse<int64_t>(*value);
  if (!number || *number < least || *number > most) {
    Refuse(name, *value,
           most == std::numeric_limits<int64_t>::max()
               ? fmt::format("an integer from {} on", least)
               : fmt::format("an integer from {} to {}", least, most));
    return std::nullopt;
  }
  return number;
}

std::optional<double> QueryReader::Number(const std::string& name, double least,
                                          double most, bool above) {
  const std::string* value = Find(name);
  if (value == nullptr) return std::nullopt;
  const auto number = Parse<double>(*value);
  if (!number || !std::isfinite(*number) || *number < least || *number > most ||
      (above && *number == least)) {
    Refuse(name, *value,
           fmt::format("a number {} {} {} {}", above ? "above" : "from", least,
                       above ? "up to" : "to", most));
    return std::nullopt;
  }
  return number;
}

std::optional<bool> QueryReader::Boolean(const std::string& name) {
  const auto word = Choice(name, {"true", "false"});
  if (!word) return std::nullopt;
  return *word == "true";
}

std::optional<std::string> QueryReader::Choice(
    const std::string& name, std::initializer_list<const char*> words) {
  const std::string* value = Find(name);
  if (value == nullptr) return std::nullopt;
  if (std::find(words.begin(), words.end(), *value) == words.end()) {
    Refuse(name, *value, fmt::format("{}", fmt::join(words, ", ")));
    return std::nullopt;
  }
  return *value;
}

Result<void> QueryReader::Finish() const {
  if (error_) return *error_;
  for (const auto& [key, text] : query_) {
    if (known_.contains(key)) continue;
    const std::string hint =
        known_.empty() ? "This operation takes no parameters."
                       : fmt::format("It takes {}.", fmt::join(known_, ", "));
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("There is no parameter {}.", key.substr(0, 64)),
                 hint, key.substr(0, 64)};
  }
  return {};
}

}  // namespace graspdb
