#include "server/jobs/low_priority.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <tbb/task_scheduler_observer.h>

namespace graspdb {
namespace {

constexpr int kNice = 10;

}  // namespace

class LowPriorityHelpers::Observer : public tbb::task_scheduler_observer {
 public:
  Observer() { observe(true); }
  ~Observer() override { observe(false); }
  // Workers of the library do nothing else; threads of ours do.
  void on_scheduler_entry(bool is_worker) override {
    if (is_worker) LowerThreadPriority();
  }
};

LowPriorityHelpers::LowPriorityHelpers()
    : observer_(std::make_unique<Observer>()) {}
LowPriorityHelpers::~LowPriorityHelpers() = default;

void LowerThreadPriority() {
  // On Linux a thread has a priority of its own. To lower it is always allowed.
  const auto thread = static_cast<id_t>(syscall(SYS_gettid));
  setpriority(PRIO_PROCESS, thread, kNice);
}

}  // namespace graspdb
