#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "server/records.h"
#include "server/store/store.h"

namespace graspdb {

/** Backups of a database in a folder beside it, the newest so many; each with a
 file of its checksum, as sha256sum(1) reads it. To restore one, serve it.
 Thread-safe. */
class BackupFolder {
 public:
  /** @param path  Made with the first backup. @param most  1 or more. */
  BackupFolder(std::string path, int most);

  /** Makes one and removes the oldest beyond `most`.
   @retval kOverloaded while one is being made.
   @retval kStorage when there is no room.
   @retval kCancelled soon after the context is. */
  Result<StoredBackup> Add(const Store& store,
                           const ExecutionContext& context = {});
  /** Newest first. */
  Result<std::vector<StoredBackup>> List() const;

 private:
  /** All beyond `most`, but not the one that was just made. */
  Result<void> RemoveOldest(const std::string& newest) const;

  const std::string path_;
  const int most_;
  std::mutex mutex_;
};

}  // namespace graspdb
