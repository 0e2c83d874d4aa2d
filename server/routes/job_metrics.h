#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "server/records.h"

namespace graspdb {

/** Counts the jobs that ended and their times for Prometheus. Thread-safe. */
class JobMetrics {
 public:
  /** @param state  Queued for one that the server's end interrupted. */
  void Add(JobKind kind, JobState state, double seconds);
  /** In Prometheus' text format. */
  std::string Write() const;

 private:
  struct Sum {
    int64_t count{0};
    double seconds{0.0};
  };

  mutable std::mutex mutex_;
  std::map<std::pair<JobKind, JobState>, Sum> sums_;
};

}  // namespace graspdb
