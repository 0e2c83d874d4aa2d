#include "server/http/log_line.h"

#include <chrono>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace graspdb {
namespace {

constexpr std::string_view kPlain =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_./:+";

std::string MakeTimestamp() {
  const auto now = std::chrono::floor<std::chrono::milliseconds>(
      std::chrono::system_clock::now());
  const auto milliseconds = now.time_since_epoch().count() % 1000;
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(now)),
                     milliseconds);
}

std::string Quote(std::string_view text) {
  constexpr size_t kMost = 200;
  text = text.substr(0, kMost);
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) {
    return std::string(text);
  }
  std::string out = "\"";
  for (const char c : text) {
    const bool plain = c >= 0x20 && c < 0x7F && c != '"' && c != '\\';
    out += plain ? c : '?';
  }
  return out + "\"";
}

}  // namespace

std::string MakeLogLine(
    std::string_view level, std::string_view event,
    const std::vector<std::pair<std::string_view, std::string>>& fields) {
  std::string line =
      fmt::format("time={} level={} event={}", MakeTimestamp(), level, event);
  for (const auto& [name, value] : fields) {
    line += fmt::format(" {}={}", name, Quote(value));
  }
  return line;
}

}  // namespace graspdb
