#include "server/routes/job_metrics.h"

#include <fmt/format.h>

#include "server/http/request_metrics.h"

namespace graspdb {

void JobMetrics::Add(JobKind kind, JobState state, double seconds) {
  const std::lock_guard lock(mutex_);
  Sum& sum = sums_[{kind, state}];
  ++sum.count;
  sum.seconds += seconds;
}

std::string JobMetrics::Write() const {
  std::string text = WriteMetricHead("graspdb_job_duration_seconds", "summary",
                                     "From when a job was begun to its end.");
  const std::lock_guard lock(mutex_);
  for (const auto& [key, sum] : sums_) {
    text += fmt::format(
        "graspdb_job_duration_seconds_sum{{kind=\"{0}\",state=\"{1}\"}} {2}\n"
        "graspdb_job_duration_seconds_count{{kind=\"{0}\",state=\"{1}\"}} "
        "{3}\n",
        ToString(key.first), ToString(key.second), sum.seconds, sum.count);
  }
  return text;
}

}  // namespace graspdb
