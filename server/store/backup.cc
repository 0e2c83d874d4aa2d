#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "server/store/store.h"
#include "server/store/store_impl.h"

namespace graspdb {
namespace {

// What was written to a file or folder is on the disk.
bool Sync(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool synced = fsync(file) == 0;
  return close(file) == 0 && synced;
}

Error MakeWriteError(const std::string& path) {
  return {ErrorCode::kStorage,
          path + " cannot be written: " + std::strerror(errno) + ".",
          "make room, or choose another place"};
}

}  // namespace

Result<void> Store::WriteBackup(const std::string& path,
                                const ExecutionContext& context) const {
  std::error_code error;
  if (std::filesystem::exists(path, error)) {
    return Error{ErrorCode::kConflict, path + " exists already.",
                 "choose another name, or remove it"};
  }
  const std::string folder = std::filesystem::path(path).parent_path();
  const std::string partial = path + ".partial";
  std::filesystem::remove(partial, error);
  const auto written = RunStorage([&] {
    // A connection of its own: readers and the writer go on.
    Database database(impl_->path, Database::Mode::kReadWrite);
    database.Heed(context);
    database.Prepare("VACUUM INTO ?").Bind(partial).Run();
  });
  if (!written) {
    std::filesystem::remove(partial, error);
    return written.error();
  }
  if (context.Cancelled()) {
    std::filesystem::remove(partial, error);
    return Error{ErrorCode::kCancelled, "The backup was cancelled."};
  }
  if (!Sync(partial) || std::rename(partial.c_str(), path.c_str()) != 0 ||
      !Sync(folder.empty() ? "." : folder)) {
    return MakeWriteError(path);
  }
  return {};
}

}  // namespace graspdb
