#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "server/files.h"
#include "server/store/store.h"
#include "server/store/store_impl.h"

namespace graspdb {
namespace {

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
  if (SyncToDisk(partial) && std::rename(partial.c_str(), path.c_str()) == 0 &&
      SyncToDisk(folder.empty() ? "." : folder)) {
    return {};
  }
  const Error failure = MakeWriteError(path);
  std::filesystem::remove(partial, error);
  std::filesystem::remove(path, error);
  return failure;
}

}  // namespace graspdb
