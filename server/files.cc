#include "server/files.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include <fmt/format.h>

namespace graspdb {
namespace {

Error MakeUnreadable(const std::string& name) {
  return Error{ErrorCode::kInvalidArgument, name + " cannot be read.",
               "check its name and permissions, or use - for standard input"};
}

Result<std::string> ReadBytes(std::FILE* file, const std::string& name) {
  std::string bytes;
  std::array<char, 65536> chunk{};
  while (const size_t count = std::fread(chunk.data(), 1, chunk.size(), file)) {
    bytes.append(chunk.data(), count);
    if (std::ssize(bytes) > kMostFileBytes) {
      return Error{
          ErrorCode::kTooLarge,
          fmt::format("{} has more than {} bytes.", name, kMostFileBytes),
          "reduce it"};
    }
  }
  if (std::ferror(file) != 0) return MakeUnreadable(name);
  return bytes;
}

}  // namespace

Result<std::string> ReadFileBytes(const std::string& path) {
  if (path == "-") return ReadBytes(stdin, "standard input");
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) {
    return Error{ErrorCode::kInvalidArgument, path + " is a folder.",
                 "name a file in it"};
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(
      std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) return MakeUnreadable(path);
  return ReadBytes(file.get(), path);
}

Result<void> WriteFileBytes(const std::string& path, const std::string& bytes) {
  if (path == "-") {
    std::fwrite(bytes.data(), 1, bytes.size(), stdout);
    return {};
  }
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), std::ssize(bytes));
  file.close();
  if (file) return {};
  return Error{ErrorCode::kInvalidArgument, path + " cannot be written.",
               "check its folder"};
}

}  // namespace graspdb
