#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <string>

namespace graspdb {

/** How a long computation hears of cancellation and deadline and tells of its
 progress: the only clock that what the engine computes may depend on. The last
 argument of every long function. Cancelled(), TimedOut() and Cancel() may be
 called from any thread, the setters only before others know of it;
 ReportProgress() is called from the computing threads, one at a
 time. */
class ExecutionContext {
 public:
  using Clock = std::chrono::steady_clock;
  /** Receives a stage's name and the share of the whole work done, 0..1. */
  using ProgressCallback = std::function<void(const std::string&, double)>;

  ExecutionContext() = default;
  explicit ExecutionContext(ProgressCallback callback)
      : callback_(std::move(callback)) {}
  ExecutionContext(const ExecutionContext&) = delete;
  ExecutionContext& operator=(const ExecutionContext&) = delete;

  void Cancel() { cancelled_ = true; }
  /** This one is cancelled and timed out, too, when the parent is; outlived by
   it. */
  void set_parent(const ExecutionContext* parent) { parent_ = parent; }
  void set_deadline(Clock::time_point deadline) { deadline_ = deadline; }

  /** True once cancelled or past the deadline: finish up. */
  bool Cancelled() const {
    return cancelled_ || IsPastDeadline() ||
           (parent_ != nullptr && parent_->Cancelled());
  }

  /** True when nobody cancelled and only the deadline has passed: what was
   found until then is wanted. */
  bool TimedOut() const {
    return !IsCancelledByCall() &&
           (IsPastDeadline() || (parent_ != nullptr && parent_->TimedOut()));
  }

  void ReportProgress(const std::string& stage, double share) {
    if (callback_) callback_(stage, share);
  }

 private:
  bool IsPastDeadline() const { return deadline_ && Clock::now() > *deadline_; }
  bool IsCancelledByCall() const {
    return cancelled_ || (parent_ != nullptr && parent_->IsCancelledByCall());
  }

  std::atomic<bool> cancelled_{false};
  std::optional<Clock::time_point> deadline_;
  const ExecutionContext* parent_{nullptr};
  ProgressCallback callback_;
};

}  // namespace graspdb
