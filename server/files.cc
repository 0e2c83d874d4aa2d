#include "server/files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <utility>

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

std::string_view CutFolders(std::string_view path) {
  return path.substr(path.find_last_of("/\\") + 1);
}

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

bool SyncToDisk(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool synced = fsync(file) == 0;
  return close(file) == 0 && synced;
}

FileLock::FileLock(FileLock&& other) noexcept
    : file_(std::exchange(other.file_, -1)) {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(file_, other.file_);
  return *this;
}

Result<FileLock> FileLock::Acquire(const std::string& path) {
  FileLock lock;
  lock.file_ = open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  if (lock.file_ < 0) {
    return Error{
        ErrorCode::kStorage,
        fmt::format("{} cannot be made: {}.", path, std::strerror(errno)),
        "check the folder's permissions"};
  }
  if (flock(lock.file_, LOCK_EX | LOCK_NB) != 0) {
    return Error{ErrorCode::kConflict,
                 fmt::format("Another process holds {}.", path),
                 "stop it first"};
  }
  return lock;
}

void FileLock::Release() {
  // The file stays: who removes it may remove another's lock.
  if (file_ >= 0) close(std::exchange(file_, -1));
}

}  // namespace graspdb
