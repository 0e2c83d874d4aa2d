#pragma once

#include <memory>

namespace graspdb {

/** While it lives, the threads that help computing give way to those that
 answer requests: on a machine whose cores are all busy learning, queries stay
 fast. */
class LowPriorityHelpers {
 public:
  LowPriorityHelpers();
  ~LowPriorityHelpers();

 private:
  class Observer;
  std::unique_ptr<Observer> observer_;
};

/** The same for the calling thread alone, for good. */
void LowerThreadPriority();

}  // namespace graspdb
