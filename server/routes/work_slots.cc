#include "server/routes/work_slots.h"

namespace graspdb {

Result<std::shared_ptr<void>> WorkSlots::Take(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  if (free_ == 0) {
    if (waiting_ >= most_waiting_) {
      return Error{ErrorCode::kOverloaded,
                   "Too many requests of this kind are at work.",
                   "send it again in a moment"};
    }
    ++waiting_;
    const bool found =
        given_back_.wait(lock, stop, [this] { return free_ > 0; });
    --waiting_;
    if (!found) {
      return Error{ErrorCode::kOverloaded, "The server is stopping.",
                   "send it again when it is back"};
    }
  }
  --free_;
  lock.unlock();
  return std::shared_ptr<void>(nullptr, [this](void*) { GiveBack(); });
}

int WorkSlots::taken() const {
  const std::lock_guard lock(mutex_);
  return most_ - free_;
}

void WorkSlots::GiveBack() {
  const std::lock_guard lock(mutex_);
  ++free_;
  given_back_.notify_one();
}

}  // namespace graspdb
