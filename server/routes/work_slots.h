#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <stop_token>

#include "engine/base/result.h"

namespace graspdb {

/** Lets so many requests of a kind be at work at once, so that the others are
 answered meanwhile. Thread-safe. */
class WorkSlots {
 public:
  /** @param most  That are at work at once, > 0. @param most_waiting  That wait
   for it; each holds a connection. */
  WorkSlots(int most, int most_waiting)
      : most_(most), free_(most), most_waiting_(most_waiting) {}

  /** Waits for a slot, which is held until the answer is dropped; this must
   outlive it.
   @retval kOverloaded when too many wait already, or it was asked to stop. */
  Result<std::shared_ptr<void>> Take(const std::stop_token& stop);
  /** How many are at work. */
  int taken() const;

 private:
  void GiveBack();

  mutable std::mutex mutex_;
  std::condition_variable_any given_back_;
  const int most_;
  int free_;
  int waiting_{0};
  const int most_waiting_;
};

}  // namespace graspdb
