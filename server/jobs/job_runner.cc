#include "server/jobs/job_runner.h"

#include <exception>
#include <set>

#include "server/codec/order_json.h"
#include "server/codec/record_json.h"
#include "server/ids.h"
#include "server/jobs/low_priority.h"
#include "server/jobs/service.h"
#include "server/jobs/sub_context.h"

namespace graspdb {
namespace {

// Below this share a rate says nothing of what is left.
constexpr double kLeastProgressForEta = 0.02;
// Of the progress of importing and learning an example.
constexpr double kImportShare = 0.05;
// How soon the store is asked again that has failed.
constexpr std::chrono::seconds kStoreRetry{2};

}  // namespace

JobRunner::JobRunner(Service& service) : service_(service) {}
JobRunner::~JobRunner() { Stop(); }

Result<void> JobRunner::Start(JobObserver observer) {
  GRASPDB_EXPECTS(workers_.empty());
  const std::string& database = service_.store().path();
  auto lock = FileLock::Acquire(database + ".lock");
  if (!lock && lock.error().code == ErrorCode::kConflict) {
    return Error{ErrorCode::kConflict,
                 "Another server works on " + database + ".",
                 "stop it first, or serve another database"};
  }
  if (!lock) return lock.error();
  lock_ = *std::move(lock);
  observer_ = std::move(observer);
  // Nobody works on what is running now: who did has died.
  const auto requeued =
      service_.store().RequeueRunningJobs(/* crashed = */ true);
  if (!requeued) return requeued.error();
  for (const StoredJob& job : requeued->given_up) TellEnd(job, 0.0);
  stopping_ = false;
  for (const bool slow : {false, true}) {
    workers_.emplace_back([this, slow] { Work(slow); });
  }
  return {};
}

void JobRunner::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    for (auto& [id, live] : live_) live.context->Cancel();
  }
  Notify();
  if (workers_.empty()) return;
  for (std::thread& worker : workers_) worker.join();
  workers_.clear();
  // What was interrupted starts again with the next server.
  if (const auto requeued =
          service_.store().RequeueRunningJobs(/* crashed = */ false);
      !requeued) {
    TellFailure("", requeued.error().message);
  }
  lock_.Release();
}

void JobRunner::Wake() { Notify(); }

void JobRunner::TellEnd(const StoredJob& job, double seconds) const {
  if (observer_.on_end) observer_.on_end(job, seconds);
}

void JobRunner::TellFailure(const std::string& job_id,
                            const std::string& what) const {
  if (observer_.on_failure) observer_.on_failure(job_id, what);
}

void JobRunner::Notify() {
  {
    const std::lock_guard lock(mutex_);
    ++changes_;
  }
  changed_.notify_all();
}

Result<StoredJob> JobRunner::Find(const std::string& id) const {
  GRASPDB_TRY(job, service_.store().FindJob(id));
  if (job.Overdue(CalcUnixMilliseconds())) {
    // Told all the same when it cannot be written.
    const bool written = FailOverdue().has_value();
    job.state = JobState::kFailed;
    job.error = MakeTimedOut();
    if (written) {
      GRASPDB_TRY(now, service_.store().FindJob(id));
      job = std::move(now);
    }
  }
  AddLiveState(job);
  return job;
}

Result<void> JobRunner::FailOverdue() const {
  GRASPDB_TRY(failed, service_.store().FailOverdueJobs());
  for (const StoredJob& job : failed) TellEnd(job, 0.0);
  return {};
}

void JobRunner::AddLiveState(StoredJob& job) const {
  const std::lock_guard lock(mutex_);
  const auto found = live_.find(job.id);
  if (found == live_.end() || job.state != JobState::kRunning) return;
  const LiveJob& live = found->second;
  job.stage = live.stage;
  job.progress = live.progress;
  if (job.kind == JobKind::kTransfer) {
    // One that was improved is there twice.
    std::set<std::string> ids;
    for (const LiveGrasp& grasp : live.grasps) ids.insert(grasp.id);
    job.grasps_found = static_cast<int64_t>(ids.size());
  }
  if (live.progress < kLeastProgressForEta) return;
  const std::chrono::duration<double> elapsed = Clock::now() - live.started;
  job.eta_seconds = elapsed.count() * (1.0 - live.progress) / live.progress;
}

std::vector<LiveGrasp> JobRunner::ReadLiveGrasps(const std::string& id,
                                                 size_t first) const {
  const std::lock_guard lock(mutex_);
  const auto found = live_.find(id);
  if (found == live_.end() || first >= found->second.grasps.size()) return {};
  return {found->second.grasps.begin() + static_cast<std::ptrdiff_t>(first),
          found->second.grasps.end()};
}

Result<StoredJob> JobRunner::Cancel(const std::string& id) {
  GRASPDB_TRY(job, Find(id));
  if (job.Finished() || CancelLive(id)) return job;
  job.state = JobState::kCancelled;
  GRASPDB_TRY(cancelled, service_.store().FinishJob(job));
  // It may have come to life meanwhile.
  if (!CancelLive(id)) TellEnd(cancelled, 0.0);
  Notify();
  return cancelled;
}

bool JobRunner::CancelLive(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto found = live_.find(id);
  if (found == live_.end()) return false;
  found->second.cancelled_by_user = true;
  found->second.context->Cancel();
  return true;
}

JobRunner::Clock::time_point JobRunner::ToClock(int64_t unix_milliseconds) {
  return Clock::now() +
         std::chrono::milliseconds(unix_milliseconds - CalcUnixMilliseconds());
}

Result<std::optional<StoredJob>> JobRunner::Claim(bool slow) {
  GRASPDB_TRY_VOID(FailOverdue());
  return service_.store().ClaimJob(slow);
}

void JobRunner::Work(bool slow) {
  LowerThreadPriority();
  StartHelperThreads(service_.options().threads);
  while (true) {
    uint64_t seen = 0;
    {
      const std::lock_guard lock(mutex_);
      if (stopping_) return;
      seen = changes_;
    }
    auto claimed = Claim(slow);
    if (claimed && *claimed) {
      Run(**claimed);
      continue;
    }
    if (!claimed) {
      TellFailure("", claimed.error().message);
    }
    // Once in a while without a call, for when the store has failed.
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kStoreRetry,
                      [&] { return stopping_ || changes_ != seen; });
  }
}

void JobRunner::Run(StoredJob job) {
  const std::string id = job.id;
  const auto begin = Clock::now();
  const auto context = std::make_shared<ExecutionContext>(
      [this, id](const std::string& stage, double share) {
        {
          const std::lock_guard lock(mutex_);
          live_[id].stage = stage;
          live_[id].progress = share;
        }
        Notify();
      });
  if (job.deadline) context->set_deadline(ToClock(*job.deadline));
  {
    const std::lock_guard lock(mutex_);
    live_[id] = {"", 0.0, Clock::now(), context, false};
    if (stopping_) context->Cancel();
  }
  Notify();
  // Who cancels it from now on finds it alive; who did before wrote so.
  if (const auto now = Find(id); now && now->Finished()) context->Cancel();
  const Result<std::string> result = context->TimedOut()
                                         ? Result<std::string>(MakeTimedOut())
                                         : Execute(job, *context);
  const std::chrono::duration<double> seconds = Clock::now() - begin;
  bool cancelled_by_user = false;
  bool interrupted = false;
  {
    const std::lock_guard lock(mutex_);
    const LiveJob& live = live_[id];
    job.stage = live.stage;
    job.progress = live.progress;
    cancelled_by_user = live.cancelled_by_user;
    interrupted = stopping_;
  }
  const bool cancelled =
      !result && result.error().code == ErrorCode::kCancelled;
  if (result) {
    job.state = JobState::kSucceeded;
    job.progress = 1.0;
    job.result_id = *result;
  } else if (cancelled && cancelled_by_user) {
    job.state = JobState::kCancelled;
  } else {
    job.state = JobState::kFailed;
    job.error =
        cancelled && context->TimedOut() ? MakeTimedOut() : result.error();
  }
  // A job that the end of the server interrupted stays as it is, to be queued.
  std::optional<StoredJob> written;
  if (!(cancelled && interrupted && !cancelled_by_user)) written = Finish(job);
  if (!written) {
    job.state = JobState::kQueued;
    job.error.reset();
  }
  TellEnd(written.value_or(job), seconds.count());
  {
    const std::lock_guard lock(mutex_);
    live_.erase(id);
  }
  Notify();
}

std::optional<StoredJob> JobRunner::Finish(const StoredJob& job) {
  bool told = false;
  while (true) {
    const auto done = service_.store().FinishJob(job);
    if (done) return *done;
    if (!told) {
      TellFailure(job.id, done.error().message);
    }
    told = true;
    // A full disk may have room again. The next server does it all again.
    std::unique_lock lock(mutex_);
    if (done.error().code != ErrorCode::kStorage ||
        changed_.wait_for(lock, kStoreRetry, [this] { return stopping_; })) {
      return std::nullopt;
    }
  }
}

Result<std::string> JobRunner::Execute(const StoredJob& job,
                                       ExecutionContext& context) {
  try {
    GRASPDB_TRY(payload, service_.store().ReadJobPayload(job.id));
    switch (job.kind) {
      case JobKind::kImport:
        return ExecuteImport(job, std::move(payload), context);
      case JobKind::kLearn: {
        GRASPDB_TRY(order, StoredLearnOrderFromJson(job.request));
        const auto spaces = service_.LearnObject(order, context);
        if (!spaces) return spaces.error();
        return order.object_id;
      }
      case JobKind::kTransfer:
        return ExecuteTransfer(job, std::move(payload), context);
      case JobKind::kSegment: {
        GRASPDB_TRY(order, StoredSegmentOrderFromJson(payload));
        GRASPDB_TRY(done, service_.Resegment(order, context));
        return done.object.id;
      }
      case JobKind::kVerify: {
        GRASPDB_TRY(order, VerifyOrderFromJson(job.request));
        const auto verified = service_.VerifyGrasps(order, context);
        if (!verified) return verified.error();
        return std::string();
      }
    }
  } catch (const std::exception& exception) {
    TellFailure(job.id, exception.what());
    return Error{ErrorCode::kInternal, exception.what()};
  }
  return Error{ErrorCode::kInternal, "The job is of no known kind."};
}

Result<std::string> JobRunner::ExecuteImport(const StoredJob& job,
                                             std::string payload,
                                             ExecutionContext& context) {
  GRASPDB_TRY(order,
              StoredImportOrderFromJson(job.request, std::move(payload)));
  const bool learn = order.role == ObjectRole::kExample && order.learn;
  SubContext importing(context, "import", 0.0, learn ? kImportShare : 1.0);
  GRASPDB_TRY(imported, service_.ImportObject(order, importing.context()));
  if (learn) {
    SubContext learning(context, "learn", kImportShare, 1.0);
    LearnOrder lesson;
    lesson.object_id = imported.object.id;
    lesson.seed = order.seed;
    const auto spaces = service_.LearnObject(lesson, learning.context());
    if (!spaces) return spaces.error();
  }
  return imported.object.id;
}

Result<std::string> JobRunner::ExecuteTransfer(const StoredJob& job,
                                               std::string payload,
                                               ExecutionContext& context) {
  GRASPDB_TRY(order,
              StoredTransferOrderFromJson(job.request, std::move(payload)));
  GRASPDB_TRY(hand, service_.FindHandModel(order.hand));
  GRASPDB_TRY(answer, service_.TransferGrasps(
                          order, context, [&](const StoredGrasp& grasp) {
                            LiveGrasp live{grasp.id, ToJson(grasp, *hand)};
                            {
                              const std::lock_guard lock(mutex_);
                              live_[job.id].grasps.push_back(std::move(live));
                            }
                            Notify();
                          }));
  return answer.transfer.id;
}

}  // namespace graspdb
