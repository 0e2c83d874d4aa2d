#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "engine/base/result.h"

namespace graspdb {

/** SHA-256 as 64 hex digits. */
std::string CalcSha256(std::string_view bytes);

/** Of a file's content.
 @retval kInvalidArgument when it cannot be read. */
Result<std::string> CalcFileSha256(const std::string& path);

/** The id of something that follows from its content: the first 32 hex digits
 of SHA-256. Join what goes in with a separator that no piece contains. */
std::string MakeContentId(std::string_view content);

/** A new UUID version 7 (RFC 9562): ordered by time of creation, also within
 one process and millisecond. */
std::string MakeUuid();

/** What comes before every UUIDv7 of that time or later, and after all others.
 */
std::string MakeUuidBound(int64_t unix_milliseconds);

/** Now, in milliseconds of Unix time. */
int64_t CalcUnixMilliseconds();

/** RFC 3339 UTC: "2024-05-01T12:00:00.000Z". */
std::string FormatTime(int64_t unix_milliseconds);

/** Now, as RFC 3339 UTC. */
std::string FormatNow();

}  // namespace graspdb
