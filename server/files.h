#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "engine/base/result.h"

namespace graspdb {

/** The largest file that is read, and the largest mesh that a server takes. */
inline constexpr int64_t kMostFileBytes = 64 << 20;

/** What a path, of any system, calls its file: all behind the last slash. */
std::string_view CutFolders(std::string_view path);

/** A file's bytes; "-" reads standard input.
 @retval kInvalidArgument when it cannot be read.
 @retval kTooLarge for more than kMostFileBytes. */
Result<std::string> ReadFileBytes(const std::string& path);

/** Writes a file anew; "-" writes to standard output.
 @retval kInvalidArgument when it cannot be written. */
Result<void> WriteFileBytes(const std::string& path, const std::string& bytes);

/** Brings what was written to a file, or which files a folder has, onto the
 disk.
 @returns whether it is there. */
bool SyncToDisk(const std::string& path);

/** A lock that one process at a time holds, until it gives it back or ends,
 however that is. */
class FileLock {
 public:
  FileLock() = default;  ///< Holds nothing.
  ~FileLock() { Release(); }
  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;

  /** @param path  Of a file for the lock alone, made when missing.
   @retval kConflict while another holds it.
   @retval kStorage when the file cannot be made. */
  static Result<FileLock> Acquire(const std::string& path);
  void Release();

 private:
  int file_{-1};
};

}  // namespace graspdb
