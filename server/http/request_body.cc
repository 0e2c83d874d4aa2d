#include "server/http/request_body.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "engine/base/utf8.h"
#include "server/http/multipart.h"
#include "server/http/problem.h"

namespace graspdb {
namespace {

// The media type without its parameters.
std::string FindEssence(const HttpRequest& request) {
  const std::string type(request.FindHeader("content-type"));
  return type.substr(0, type.find_first_of("; \t"));
}

std::optional<HttpResponse> CheckType(BodyKind kind,
                                      const HttpRequest& request) {
  if (kind == BodyKind::kNone) {
    return MakeProblem(HttpFault::kMalformedRequest,
                       "This operation takes no body.", "", request.id);
  }
  const std::string_view coding = request.FindHeader("content-encoding");
  if (!coding.empty() && coding != "identity") {
    return MakeProblem(HttpFault::kUnsupportedMediaType,
                       "A body is read without content coding only.",
                       "Send the bytes uncompressed.", request.id);
  }
  const std::string essence = FindEssence(request);
  if (kind == BodyKind::kJson && !essence.empty() &&
      essence != "application/json") {
    return MakeProblem(HttpFault::kUnsupportedMediaType,
                       "This operation reads application/json.",
                       "Send the header Content-Type: application/json.",
                       request.id);
  }
  return std::nullopt;
}

HttpResponse MakeTooLarge(size_t limit, const std::string& id) {
  return MakeProblem(
      {ErrorCode::kTooLarge,
       fmt::format("A body has at most {} bytes here.", limit),
       "Send a smaller file, or ask the operator to raise the limit."},
      id);
}

// @param expected  The body's size when it is known, or 0.
std::optional<HttpResponse> ReadBytes(size_t limit, size_t expected,
                                      const std::shared_ptr<HeldBody>& held,
                                      const BodySource& source,
                                      HttpRequest& request) {
  bool too_large = false;
  bool too_many = false;
  const BodyEnd end = source([&](std::string_view bytes) {
    const size_t whole = request.body.size() + bytes.size();
    too_large = whole > limit;
    too_many = !held->Grow(whole);
    if (too_large || too_many) return false;
    // Taken from the system as it is filled, and never copied.
    if (request.body.empty()) request.body.reserve(expected);
    request.body += bytes;
    return true;
  });
  if (too_large) return MakeTooLarge(limit, request.id);
  if (too_many) {
    return MakeProblem({ErrorCode::kOverloaded,
                        "Too many large bodies are being sent at once.",
                        "Send it again in a moment."},
                       request.id);
  }
  switch (end) {
    case BodyEnd::kTimedOut:
      return MakeProblem(HttpFault::kRequestTimeout,
                         "The body did not arrive in time.", "", request.id);
    case BodyEnd::kBroken:
      return MakeProblem(HttpFault::kMalformedRequest,
                         "The body ended early or its chunks are broken.", "",
                         request.id);
    case BodyEnd::kWhole:
      break;
  }
  return std::nullopt;
}

std::optional<HttpResponse> ReadForm(const HttpLimits& limits,
                                     HttpRequest& request) {
  auto parts =
      ParseMultipart(request.body, request.FindHeader("content-type"), limits);
  if (!parts) return MakeProblem(parts.error(), request.id);
  std::string().swap(request.body);  // clear() would keep its memory.
  for (FormPart& part : *parts) {
    if (!part.filename.empty()) {
      request.files.push_back(std::move(part));
    } else if (IsUtf8(part.content)) {
      request.query.emplace_back(std::move(part.name), std::move(part.content));
    } else {
      return MakeProblem(
          {ErrorCode::kInvalidArgument, "A form field is not UTF-8 text.",
           "Send the mesh as a file: -F mesh=@FILE.", part.name},
          request.id);
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<HttpResponse> ReadRequestBody(
    const MessageHead& head, BodyKind kind, const HttpLimits& limits,
    BodyBudget& budget, const BodySource& source, HttpRequest& request) {
  if (!head.HasBody()) return std::nullopt;
  if (auto refusal = CheckType(kind, request)) return refusal;
  const bool upload = kind == BodyKind::kUpload;
  const size_t limit = upload ? static_cast<size_t>(limits.max_upload_bytes)
                              : limits.max_json_bytes;
  if (head.content_length > limit) return MakeTooLarge(limit, request.id);
  const auto held = std::make_shared<HeldBody>(budget);
  request.held = held;
  if (auto refusal =
          ReadBytes(limit, std::min(head.content_length, limits.max_held_bytes),
                    held, source, request)) {
    return refusal;
  }
  const bool form = FindEssence(request) == "multipart/form-data";
  return upload && form ? ReadForm(limits, request) : std::nullopt;
}

}  // namespace graspdb
