#include "server/config.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include <toml++/toml.h>

namespace graspdb {
namespace {

constexpr std::array<std::string_view, 13> kSettings{"db",
                                                     "host",
                                                     "port",
                                                     "server",
                                                     "threads",
                                                     "port_file",
                                                     "wait",
                                                     "http_threads",
                                                     "max_upload_bytes",
                                                     "max_queued_jobs",
                                                     "max_backups",
                                                     "decoder",
                                                     "allow_unsandboxed"};

std::string ToText(const toml::node& value) {
  if (const auto* text = value.as_string()) return text->get();
  std::ostringstream out;
  value.visit([&](const auto& node) { out << node; });
  return out.str();
}

}  // namespace

Result<void> LoadConfigFile(const std::string& path) {
  toml::table table;
  try {
    table = toml::parse_file(path);
  } catch (const toml::parse_error& error) {
    std::ostringstream where;
    where << error.source().begin;
    return Error{ErrorCode::kInvalidArgument,
                 path + ", " + where.str() + ": " +
                     std::string(error.description()) + ".",
                 "correct it, or name another file with --config"};
  }
  for (const auto& [key, value] : table) {
    const std::string_view name = key.str();
    const bool known =
        std::find(kSettings.begin(), kSettings.end(), name) != kSettings.end();
    if (!known || value.is_table() || value.is_array()) {
      std::string settings;
      for (const std::string_view setting : kSettings) {
        settings += (settings.empty() ? "" : ", ") + std::string(setting);
      }
      return Error{ErrorCode::kInvalidArgument,
                   path + ": " + std::string(name) + " is not a setting.",
                   "known: " + settings, std::string(name)};
    }
    std::string variable = "GRASPDB_";
    for (const char c : name) {
      variable += static_cast<char>(std::toupper(c));
    }
    constexpr int kKeepWhatIsSet = 0;
    setenv(variable.c_str(), ToText(value).c_str(), kKeepWhatIsSet);
  }
  return {};
}

}  // namespace graspdb
