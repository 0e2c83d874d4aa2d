#include "server/http/problem.h"

#include <array>

#include <nlohmann/json.hpp>

namespace graspdb {
namespace {

HttpResponse Render(const ProblemKind& kind, const std::string& detail,
                    const std::string& hint, const std::string& field,
                    const std::string& request_id) {
  nlohmann::ordered_json body;
  body["type"] = std::string("urn:graspdb:problem:") + kind.code;
  body["title"] = kind.title;
  body["status"] = kind.status;
  body["detail"] = detail;
  if (!hint.empty()) body["hint"] = hint;
  if (!field.empty()) body["field"] = field;
  body["code"] = kind.code;
  body["request_id"] = request_id;
  HttpResponse response;
  response.status = kind.status;
  response.content_type = "application/problem+json";
  response.body =
      body.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) +
      "\n";
  if (kind.retryable) response.headers.emplace_back("Retry-After", "1");
  return response;
}

}  // namespace

ProblemKind KindOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidArgument:
      return {"invalid_argument", "A parameter has an unusable value", 400,
              false};
    case ErrorCode::kUnusableInput:
      return {"unusable_input", "The input cannot be used", 422, false};
    case ErrorCode::kTooLarge:
      return {"too_large", "A size limit is exceeded", 413, false};
    case ErrorCode::kNotFound:
      return {"not_found", "There is no such thing", 404, false};
    case ErrorCode::kConflict:
      return {"conflict", "The request contradicts what is stored", 409, false};
    case ErrorCode::kNotInCategory:
      return {"not_in_category", "The object matches no example", 422, false};
    case ErrorCode::kCancelled:
      return {"cancelled", "The work was cancelled", 409, false};
    case ErrorCode::kDeadlineExceeded:
      return {"deadline_exceeded", "The time allowed ran out", 503, true};
    case ErrorCode::kStorage:
      return {"storage", "The database cannot be written or read", 507, true};
    case ErrorCode::kOverloaded:
      return {"overloaded", "Too much is asked for at once", 503, true};
    case ErrorCode::kKeyReused:
      return {"key_reused", "The Idempotency-Key stands for another request",
              422, false};
    case ErrorCode::kNotImplemented:
      return {"not_implemented", "Announced, but not built yet", 501, false};
    case ErrorCode::kInternal:
      return {"internal", "The server made a mistake", 500, false};
  }
  return KindOf(ErrorCode::kInternal);
}

ProblemKind KindOf(HttpFault fault) {
  switch (fault) {
    case HttpFault::kMalformedRequest:
      return {"malformed_request", "The request is not well formed", 400,
              false};
    case HttpFault::kRequestTimeout:
      return {"request_timeout", "The request did not arrive in time", 408,
              true};
    case HttpFault::kMethodNotAllowed:
      return {"method_not_allowed", "The method does not exist here", 405,
              false};
    case HttpFault::kNotAcceptable:
      return {"not_acceptable", "No acceptable representation", 406, false};
    case HttpFault::kUriTooLong:
      return {"uri_too_long", "The request line is too long", 414, false};
    case HttpFault::kUnsupportedMediaType:
      return {"unsupported_media_type", "The content type is not read here",
              415, false};
    case HttpFault::kHeaderFieldsTooLarge:
      return {"header_fields_too_large", "The header fields are too large", 431,
              false};
  }
  return KindOf(ErrorCode::kInternal);
}

std::span<const ProblemKind> AllProblemKinds() {
  static const std::array kinds{
      KindOf(ErrorCode::kInvalidArgument),
      KindOf(ErrorCode::kUnusableInput),
      KindOf(ErrorCode::kTooLarge),
      KindOf(ErrorCode::kNotFound),
      KindOf(ErrorCode::kConflict),
      KindOf(ErrorCode::kNotInCategory),
      KindOf(ErrorCode::kCancelled),
      KindOf(ErrorCode::kDeadlineExceeded),
      KindOf(ErrorCode::kStorage),
      KindOf(ErrorCode::kOverloaded),
      KindOf(ErrorCode::kKeyReused),
      KindOf(ErrorCode::kNotImplemented),
      KindOf(ErrorCode::kInternal),
      KindOf(HttpFault::kMalformedRequest),
      KindOf(HttpFault::kRequestTimeout),
      KindOf(HttpFault::kMethodNotAllowed),
      KindOf(HttpFault::kNotAcceptable),
      KindOf(HttpFault::kUriTooLong),
      KindOf(HttpFault::kUnsupportedMediaType),
      KindOf(HttpFault::kHeaderFieldsTooLarge),
  };
  return kinds;
}

HttpResponse MakeProblem(const Error& error, const std::string& request_id) {
  if (error.code == ErrorCode::kInternal) {
    return Render(KindOf(error.code),
                  "An unexpected error was logged under this request id.",
                  "Report the request id with what you did.", "", request_id);
  }
  if (error.code == ErrorCode::kStorage) {
    // Its message may name files of the server.
    return Render(KindOf(error.code),
                  "The database, or what is beside it, cannot be written or "
                  "read now; why was logged under this request id.",
                  error.hint, "", request_id);
  }
  return Render(KindOf(error.code), error.message, error.hint, error.field,
                request_id);
}

HttpResponse MakeProblem(HttpFault fault, const std::string& detail,
                         const std::string& hint,
                         const std::string& request_id) {
  return Render(KindOf(fault), detail, hint, "", request_id);
}

}  // namespace graspdb
