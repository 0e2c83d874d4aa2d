#include "server/http/request_metrics.h"

#include <algorithm>

#include <fmt/format.h>

namespace graspdb {
namespace {

// Methods and patterns that are none of ours share a name: a client must not be
// able to make the server count without end.
std::string OrOther(const std::string& text) {
  return text.empty() ? "other" : text;
}

bool IsKnownMethod(const std::string& method) {
  constexpr std::array kMethods{"GET", "HEAD", "POST", "PATCH", "DELETE"};
  return std::find(kMethods.begin(), kMethods.end(), method) != kMethods.end();
}

}  // namespace

std::string WriteMetricHead(const std::string& name, const std::string& type,
                            const std::string& help) {
  return fmt::format("# HELP {0} {2}\n# TYPE {0} {1}\n", name, type, help);
}

void RequestMetrics::Begin() {
  const std::lock_guard lock(mutex_);
  ++in_flight_;
}

void RequestMetrics::End(const RequestRecord& record) {
  const std::string method =
      IsKnownMethod(record.method) ? record.method : "other";
  const std::string route = OrOther(record.pattern);
  const std::lock_guard lock(mutex_);
  --in_flight_;
  ++requests_[{method, route, record.status}];
  Histogram& histogram = seconds_[{method, route}];
  ++histogram.count;
  histogram.sum += record.seconds;
  const auto bucket =
      std::lower_bound(kBuckets.begin(), kBuckets.end(), record.seconds);
  if (bucket != kBuckets.end()) {
    ++histogram.counts[static_cast<size_t>(bucket - kBuckets.begin())];
  }
}

void RequestMetrics::AddDropped() {
  const std::lock_guard lock(mutex_);
  ++dropped_;
}

std::string RequestMetrics::Write() const {
  const std::lock_guard lock(mutex_);
  std::string text = WriteMetricHead("graspdb_http_requests_in_flight", "gauge",
                                     "Requests being answered.");
  text += fmt::format("graspdb_http_requests_in_flight {}\n", in_flight_);
  text += WriteMetricHead("graspdb_http_connections_dropped_total", "counter",
                          "Connections closed unread: too many at once.");
  text += fmt::format("graspdb_http_connections_dropped_total {}\n", dropped_);
  text += WriteMetricHead("graspdb_http_requests_total", "counter",
                          "Requests answered.");
  for (const auto& [key, count] : requests_) {
    const auto& [method, route, status] = key;
    text += fmt::format(
        "graspdb_http_requests_total{{method=\"{}\",route=\"{}"
        "\",status=\"{}\"}}"
        " {}\n",
        method, route, status, count);
  }
  text += WriteMetricHead("graspdb_http_request_duration_seconds", "histogram",
                          "From the head's arrival to the answer's end.");
  for (const auto& [key, histogram] : seconds_) {
    const std::string labels =
        fmt::format("method=\"{}\",route=\"{}\"", key.first, key.second);
    uint64_t below = 0;
    for (size_t i = 0; i < kBuckets.size(); ++i) {
      below += histogram.counts[i];
      text += fmt::format(
          "graspdb_http_request_duration_seconds_bucket{{{},le=\"{}\"}} {}\n",
          labels, kBuckets[i], below);
    }
    text += fmt::format(
        "graspdb_http_request_duration_seconds_bucket{{{0},le=\"+Inf\"}} {1}\n"
        "graspdb_http_request_duration_seconds_sum{{{0}}} {2}\n"
        "graspdb_http_request_duration_seconds_count{{{0}}} {1}\n",
        labels, histogram.count, histogram.sum);
  }
  return text;
}

}  // namespace graspdb
