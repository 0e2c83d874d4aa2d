#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <tuple>
#include <utility>

namespace graspdb {

/** One answered request. */
struct RequestRecord {
  std::string method;   ///< As sent; "" when the head could not be read.
  std::string pattern;  ///< Of the route, so that ids do not count; "" if none.
  int status{0};
  double seconds{0.0};
};

/** Counts requests and their times for Prometheus. Thread-safe. */
class RequestMetrics {
 public:
  /** Upper ends of the histogram's buckets, s. */
  static constexpr std::array kBuckets{0.001, 0.0025, 0.005, 0.01, 0.025,
                                       0.05,  0.1,    0.25,  0.5,  1.0,
                                       2.5,   5.0,    10.0,  30.0, 60.0};

  void Begin();
  void End(const RequestRecord& record);
  /** A connection was closed unread, for want of time even to refuse it. */
  void AddDropped();
  /** In Prometheus' text format, sorted by label. */
  std::string Write() const;

 private:
  struct Histogram {
    std::array<uint64_t, kBuckets.size()> counts{};  // Of each bucket alone.
    uint64_t count{0};
    double sum{0.0};
  };

  mutable std::mutex mutex_;
  int in_flight_{0};
  uint64_t dropped_{0};
  // By method, pattern and status.
  std::map<std::tuple<std::string, std::string, int>, uint64_t> requests_;
  std::map<std::pair<std::string, std::string>, Histogram> seconds_;
};

/** What Prometheus' text format asks for before the first sample of a metric.
 @param type  counter, gauge or histogram. */
std::string WriteMetricHead(const std::string& name, const std::string& type,
                            const std::string& help);

}  // namespace graspdb
