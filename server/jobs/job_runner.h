#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "server/files.h"
#include "server/jobs/job_observer.h"
#include "server/jobs/live_grasp.h"
#include "server/records.h"

namespace graspdb {

class Service;

/** Takes jobs from the store and carries them out by the service's verbs, one
 after the other in each of its two threads: slow ones, and those someone waits
 for. The row of a job says where it stands at rest; while it runs, its progress
 is only here. */
class JobRunner {
 public:
  explicit JobRunner(Service& service);
  ~JobRunner();
  JobRunner(const JobRunner&) = delete;
  JobRunner& operator=(const JobRunner&) = delete;

  /** @retval kConflict while another process works on the database's jobs. */
  Result<void> Start(JobObserver observer);
  void Stop();
  /** There is a new job. */
  void Wake();

  /** One whose deadline passed while it was queued has failed. */
  Result<StoredJob> Find(const std::string& id) const;
  /** Those whose turn would come too late end, and give place to others. */
  Result<void> FailOverdue() const;
  /** Adds progress, stage and eta to a job that runs here. */
  void AddLiveState(StoredJob& job) const;
  /** What a running transfer has found, in the order of finding, from the
   `first`-th on. Empty when it does not run here. */
  std::vector<LiveGrasp> ReadLiveGrasps(const std::string& id,
                                        size_t first) const;
  Result<StoredJob> Cancel(const std::string& id);
  /** Returns when `enough(job)`, or after the timeout. */
  template <class F>
  Result<StoredJob> WaitUntil(const std::string& id,
                              std::chrono::milliseconds timeout,
                              F&& enough) const;

 private:
  using Clock = ExecutionContext::Clock;
  struct LiveJob {
    std::string stage;
    double progress{0.0};
    Clock::time_point started;
    std::shared_ptr<ExecutionContext> context;
    bool cancelled_by_user{false};
    std::vector<LiveGrasp> grasps{};
  };

  // @param unix_milliseconds  A job's deadline.
  static Clock::time_point ToClock(int64_t unix_milliseconds);
  void Work(bool slow);
  Result<std::optional<StoredJob>> Claim(bool slow);
  void Run(StoredJob job);
  // Whether it runs here.
  bool CancelLive(const std::string& id);
  // Writes what became of it, as soon as that can be written.
  // @returns the row, or nothing when the server stopped before that.
  std::optional<StoredJob> Finish(const StoredJob& job);
  // The id of what the job made.
  Result<std::string> Execute(const StoredJob& job, ExecutionContext& context);
  Result<std::string> ExecuteImport(const StoredJob& job, std::string payload,
                                    ExecutionContext& context);
  Result<std::string> ExecuteTransfer(const StoredJob& job, std::string payload,
                                      ExecutionContext& context);
  void TellEnd(const StoredJob& job, double seconds) const;
  void TellFailure(const std::string& job_id, const std::string& what) const;
  // Something that waiters may wait for has changed.
  void Notify();

  Service& service_;
  JobObserver observer_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  uint64_t changes_{0};
  bool stopping_{false};
  std::map<std::string, LiveJob> live_;
  std::vector<std::thread> workers_;
  FileLock lock_;  // While there are workers.
};

template <class F>
Result<StoredJob> JobRunner::WaitUntil(const std::string& id,
                                       std::chrono::milliseconds timeout,
                                       F&& enough) const {
  const auto deadline = Clock::now() + timeout;
  while (true) {
    uint64_t seen = 0;
    {
      const std::lock_guard lock(mutex_);
      seen = changes_;
    }
    GRASPDB_TRY(job, Find(id));
    if (job.Finished() || enough(job) || Clock::now() >= deadline) return job;
    auto wake = deadline;
    if (job.state == JobState::kQueued && job.deadline) {
      wake = std::min(wake, ToClock(*job.deadline));
    }
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, wake, [&] { return changes_ != seen; });
  }
}

}  // namespace graspdb
