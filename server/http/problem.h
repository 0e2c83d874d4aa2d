#pragma once

#include <span>
#include <string>

#include "engine/base/result.h"
#include "server/http/message.h"

namespace graspdb {

/** What HTTP itself can refuse, beside the engine's ErrorCode. */
enum class HttpFault {
  kMalformedRequest,      ///< Framing or syntax of the message is broken.
  kRequestTimeout,        ///< The head or body did not arrive in time.
  kMethodNotAllowed,      ///< The path exists, the method does not.
  kNotAcceptable,         ///< No representation that the client accepts.
  kUriTooLong,            ///< The request line exceeds its limit.
  kUnsupportedMediaType,  ///< A content type or coding that is not read here.
  kHeaderFieldsTooLarge,  ///< Header fields exceed a limit.
};

/** One row of schema/errors.yaml. */
struct ProblemKind {
  const char* code;   ///< Stable name on the wire.
  const char* title;  ///< Short, the same for each occurrence.
  int status;
  bool retryable;  ///< The same request may succeed later.
};

/** The one place that maps kinds of errors to HTTP. */
ProblemKind KindOf(ErrorCode code);
ProblemKind KindOf(HttpFault fault);

/** Every kind, ErrorCode first, in the order of the enums. */
std::span<const ProblemKind> AllProblemKinds();

/** The RFC 9457 answer to an expected failure. Bytes of the message that are
 not UTF-8 are replaced. kInternal never shows its message. */
HttpResponse MakeProblem(const Error& error, const std::string& request_id);
HttpResponse MakeProblem(HttpFault fault, const std::string& detail,
                         const std::string& hint,
                         const std::string& request_id);

}  // namespace graspdb
