#include "server/routes/job_events.h"

#include <charconv>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "server/codec/record_json.h"

namespace graspdb {
namespace {

using std::chrono::milliseconds;

// Between two looks at whether the server stops.
constexpr milliseconds kStep{200};
// Progress comes in steps of microseconds; nobody reads that fast.
constexpr milliseconds kLeastPause{100};
// A silent connection is told that it is alive, and found out when it is not.
constexpr std::chrono::seconds kHeartbeat{10};

}  // namespace

JobEvents::JobEvents(const Service& service, StoredJob job,
                     const std::string& last_event_id, std::stop_token stop)
    : service_(service), job_(std::move(job)), stop_(std::move(stop)) {
  // <when the run began>/<grasps told>
  const size_t slash = last_event_id.rfind('/');
  if (slash == std::string::npos) return;
  size_t told = 0;
  const char* const end = last_event_id.data() + last_event_id.size();
  const auto [stop_at, error] =
      std::from_chars(last_event_id.data() + slash + 1, end, told);
  if (error != std::errc() || stop_at != end) return;
  run_ = last_event_id.substr(0, slash);
  told_ = told;
}

std::optional<std::string> JobEvents::Next() {
  while (!ended_ && !stop_.stop_requested()) {
    if (std::exchange(first_, false)) return Describe(job_);
    std::this_thread::sleep_until(last_ + kLeastPause);
    const auto job = service_.WaitForChange(job_, kStep);
    if (!job) return std::nullopt;
    const bool changed = job->state != job_.state || job->stage != job_.stage ||
                         job->progress != job_.progress ||
                         job->grasps_found != job_.grasps_found;
    job_ = *job;
    if (changed) return Describe(job_);
    if (Clock::now() - last_ >= kHeartbeat) {
      last_ = Clock::now();
      return ": still at it\n\n";
    }
  }
  return std::nullopt;
}

std::string JobEvents::Describe(const StoredJob& job) {
  if (run_ != job.started_at) {
    run_ = job.started_at;
    told_ = 0;
  }
  ended_ = job.Finished();
  last_ = Clock::now();
  std::string events =
      ended_ ? DescribeStoredGrasps(job) : DescribeFoundGrasps(job);
  events += WriteEvent("job", ToJson(job));
  return events;
}

std::string JobEvents::DescribeFoundGrasps(const StoredJob& job) {
  std::string events;
  for (const auto& [id, json] : service_.ReadLiveGrasps(job.id, told_)) {
    ++told_;
    sent_[id] = json;
    events += WriteEvent("grasp", json);
  }
  return events;
}

// Those that ended between the last look and the job's end, or were found
// before anyone looked.
std::string JobEvents::DescribeStoredGrasps(const StoredJob& job) {
  if (job.kind != JobKind::kTransfer || job.state != JobState::kSucceeded) {
    return "";
  }
  const auto answer = service_.DescribeTransfer(job.result_id, std::nullopt);
  if (!answer) return "";
  std::string events;
  for (const StoredGrasp& grasp : answer->grasps) {
    std::string json = ToJson(grasp, *answer->hand);
    std::string& sent = sent_[grasp.id];
    if (sent == json) continue;
    ++told_;
    events += WriteEvent("grasp", json);
    sent = std::move(json);
  }
  return events;
}

std::string JobEvents::WriteEvent(const std::string& event,
                                  const std::string& data) const {
  return fmt::format("id: {}/{}\nevent: {}\ndata: {}\n\n", run_, told_, event,
                     data);
}

}  // namespace graspdb
