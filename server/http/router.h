#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "server/http/message.h"

namespace graspdb {

/** What kind of body an operation reads. */
enum class BodyKind {
  kNone,    ///< None; a body is refused.
  kJson,    ///< application/json.
  kUpload,  ///< A file: raw bytes, or multipart/form-data.
};

using HttpHandler = std::function<Result<HttpResponse>(HttpRequest&)>;

/** One operation: a method on a path pattern. */
struct Route {
  std::string method;
  std::string pattern;  ///< E.g. "/v1/grasps/{id}.png".
  BodyKind body{BodyKind::kNone};
  HttpHandler handler;
  /** Answered also when there is no time for others. */
  bool vital{false};
};

/** Which route answers a request. */
struct RouteMatch {
  const Route* route{nullptr};  ///< Null when none does.
  std::map<std::string, std::string> path_parameters;
  /** Methods that the path has; empty when there is no such path. */
  std::vector<std::string> allowed;
};

/** Finds the route of a request by its path segments. A segment of a pattern
 is literal text or one parameter with an optional literal suffix, {id}.png.
 Among several matches the one with the most literal text wins. */
class Router {
 public:
  /** @pre No route with the same method and pattern was added before. */
  void Add(Route route);

  const std::vector<Route>& routes() const { return routes_; }

  /** @param segments The decoded path segments; see ParseTarget(). The pointer
   in the answer is valid until the next Add(). */
  RouteMatch Find(const std::string& method,
                  const std::vector<std::string>& segments) const;

 private:
  std::vector<Route> routes_;
  std::vector<std::vector<std::string>> patterns_;  ///< Segments per route.
};

}  // namespace graspdb
