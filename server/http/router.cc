#include "server/http/router.h"

#include <algorithm>
#include <optional>

#include "engine/base/contract.h"
#include "server/http/target.h"

namespace graspdb {
namespace {

using Parameters = std::map<std::string, std::string>;

/** The number of literal characters matched, or nothing. */
std::optional<size_t> MatchSegment(const std::string& pattern,
                                   const std::string& segment,
                                   Parameters& parameters) {
  if (!pattern.starts_with('{')) {
    if (pattern != segment) return std::nullopt;
    return pattern.size();
  }
  const size_t close = pattern.find('}');
  const std::string suffix = pattern.substr(close + 1);
  if (segment.size() <= suffix.size() || !segment.ends_with(suffix)) {
    return std::nullopt;
  }
  parameters[pattern.substr(1, close - 1)] =
      segment.substr(0, segment.size() - suffix.size());
  return suffix.size();
}

std::optional<size_t> MatchPath(const std::vector<std::string>& pattern,
                                const std::vector<std::string>& segments,
                                Parameters& parameters) {
  if (pattern.size() != segments.size()) return std::nullopt;
  size_t literal = 0;
  for (size_t i = 0; i < pattern.size(); ++i) {
    const auto count = MatchSegment(pattern[i], segments[i], parameters);
    if (!count) return std::nullopt;
    literal += *count;
  }
  return literal;
}

}  // namespace

void Router::Add(Route route) {
  const auto pattern = ParseTarget(route.pattern);
  GRASPDB_EXPECTS(pattern.has_value() && route.handler);
  for (const Route& other : routes_) {
    GRASPDB_EXPECTS(other.method != route.method ||
                    other.pattern != route.pattern);
  }
  routes_.push_back(std::move(route));
  patterns_.push_back(pattern->segments);
}

RouteMatch Router::Find(const std::string& method,
                        const std::vector<std::string>& segments) const {
  RouteMatch best;
  size_t best_literal = 0;
  bool found = false;
  for (size_t i = 0; i < routes_.size(); ++i) {
    Parameters parameters;
    const auto literal = MatchPath(patterns_[i], segments, parameters);
    if (!literal || (found && *literal < best_literal)) continue;
    if (!found || *literal > best_literal) {
      best = {};
      best_literal = *literal;
      found = true;
    }
    best.allowed.push_back(routes_[i].method);
    if (routes_[i].method == method) {
      best.route = &routes_[i];
      best.path_parameters = std::move(parameters);
    }
  }
  std::sort(best.allowed.begin(), best.allowed.end());
  return best;
}

}  // namespace graspdb
