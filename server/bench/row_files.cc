#include "server/bench/row_files.h"

#include <cctype>
#include <system_error>
#include <utility>

#include "server/files.h"

namespace graspdb {

namespace fs = std::filesystem;

RowFiles::RowFiles(fs::path folder) : folder_(std::move(folder)) {}

Result<void> RowFiles::MakeFolder() const {
  std::error_code code;
  fs::create_directories(folder_, code);
  if (code) {
    return Error{ErrorCode::kInvalidArgument,
                 folder_.string() + " cannot be made: " + code.message() + ".",
                 "name a folder that can be written to"};
  }
  return {};
}

std::optional<Json> RowFiles::Read(const std::string& name,
                                   const std::string& key) const {
  const fs::path file = MakePath(name);
  if (!fs::exists(file)) return std::nullopt;
  const auto text = ReadFileBytes(file);
  if (!text) return std::nullopt;
  const Json known = Json::parse(*text, nullptr, false);
  if (!known.is_object() || known.value("key", "") != key) return std::nullopt;
  return known["rows"];
}

Result<void> RowFiles::Write(const std::string& name, const std::string& key,
                             const Json& rows) const {
  Json written;
  written["key"] = key;
  written["rows"] = rows;
  const fs::path file = MakePath(name);
  const fs::path draft = file.string() + ".new";
  GRASPDB_TRY_VOID(WriteFileBytes(draft, written.dump(1)));
  fs::rename(draft, file);
  return {};
}

fs::path RowFiles::MakePath(const std::string& name) const {
  std::string plain = name;
  for (char& c : plain) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '-';
  }
  return folder_ / (plain + ".json");
}

}  // namespace graspdb
