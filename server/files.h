#pragma once

#include <cstdint>
#include <string>

#include "engine/base/result.h"

namespace graspdb {

/** The largest file that is read, and the largest mesh that a server takes. */
inline constexpr int64_t kMostFileBytes = 64 << 20;

/** A file's bytes; "-" reads standard input.
 @retval kInvalidArgument when it cannot be read.
 @retval kTooLarge for more than kMostFileBytes. */
Result<std::string> ReadFileBytes(const std::string& path);

/** Writes a file anew; "-" writes to standard output.
 @retval kInvalidArgument when it cannot be written. */
Result<void> WriteFileBytes(const std::string& path, const std::string& bytes);

}  // namespace graspdb
