#include "server/http/dispatcher.h"

#include <algorithm>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "server/http/log_line.h"
#include "server/http/problem.h"
#include "server/http/site.h"
#include "server/http/target.h"

namespace graspdb {
namespace {

/** Instead of a route, in the metrics. */
constexpr char kTurnedAwayRoute[] = "turned away";

}  // namespace

Dispatcher::Dispatcher(Router router, const HttpLimits& limits,
                       std::function<void(const std::string&)> log)
    : router_(std::move(router)),
      limits_(limits),
      log_(std::move(log)),
      budget_(std::max(limits.max_held_bytes,
                       2 * static_cast<size_t>(std::max<int64_t>(
                               0, limits.max_upload_bytes)))) {}

Dispatcher::Answer Dispatcher::Dispatch(const Request& request) {
  const std::string& id = request.id;
  if (const auto fault = FindForeignSite(request.head, request.on_loopback)) {
    return {MakeProblem(HttpFault::kMalformedRequest, *fault, "", id), ""};
  }
  const auto target = ParseTarget(request.head.target);
  if (!target) {
    return {MakeProblem(HttpFault::kMalformedRequest, target.error().message,
                        target.error().hint, id),
            ""};
  }
  HttpRequest decoded;
  decoded.id = id;
  decoded.method = request.head.method == "HEAD" ? "GET" : request.head.method;
  for (const auto& segment : target->segments) decoded.path += "/" + segment;
  if (decoded.path.empty()) decoded.path = "/";
  RouteMatch match = router_.Find(decoded.method, target->segments);
  if (match.route == nullptr && match.allowed.empty()) {
    return {MakeProblem({ErrorCode::kNotFound,
                         fmt::format("There is nothing at {}.",
                                     decoded.path.substr(0, 200)),
                         "GET /openapi.json lists every path."},
                        id),
            ""};
  }
  if (match.route == nullptr) {
    const std::string allowed =
        fmt::format("{}", fmt::join(match.allowed, ", "));
    HttpResponse response = MakeProblem(
        HttpFault::kMethodNotAllowed,
        fmt::format("{} takes {}.", decoded.path.substr(0, 200), allowed), "",
        id);
    response.headers.emplace_back("Allow", allowed);
    return {std::move(response), ""};
  }
  if (request.turned_away && !match.route->vital) return TurnAway(id);
  decoded.path_parameters = std::move(match.path_parameters);
  decoded.query = target->query;
  decoded.headers = request.head.fields;
  decoded.stop = request.stop;
  return {Call(*match.route, request, decoded), match.route->pattern};
}

Dispatcher::Answer Dispatcher::TurnAway(const std::string& id) {
  return {MakeProblem({ErrorCode::kOverloaded,
                       "More connections wait than can be served.",
                       "wait as long as Retry-After says"},
                      id),
          kTurnedAwayRoute};
}

HttpResponse Dispatcher::Call(const Route& route, const Request& request,
                              HttpRequest& decoded) {
  Error error{ErrorCode::kInternal, kUnknownException, ""};
  try {
    auto refusal = ReadRequestBody(request.head, route.body, limits_, budget_,
                                   request.body, decoded);
    if (refusal) return std::move(*refusal);
    auto response = route.handler(decoded);
    if (response) return std::move(*response);
    error = response.error();
  } catch (const std::exception& exception) {
    error.message = exception.what();
  } catch (...) {
  }
  if (error.code == ErrorCode::kCancelled && decoded.stop.stop_requested()) {
    error = {ErrorCode::kOverloaded, "The server is stopping.",
             "send it again when it is back"};
  }
  if (error.code == ErrorCode::kInternal)
    LogInternal(decoded.id, error.message);
  if (error.code == ErrorCode::kStorage && log_) {
    log_(MakeLogLine("error", "storage",
                     {{"id", decoded.id}, {"cause", error.message}}));
  }
  return MakeProblem(error, decoded.id);
}

void Dispatcher::LogInternal(const std::string& id,
                             const std::string& cause) const {
  if (log_) {
    log_(MakeLogLine("error", "internal", {{"id", id}, {"cause", cause}}));
  }
}

}  // namespace graspdb
