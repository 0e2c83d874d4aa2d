#include "server/jobs/low_priority.h"

#include <chrono>
#include <thread>

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "engine/base/parallel.h"

namespace graspdb {
namespace {

// Half the share of who answers. With much less a transfer that someone watches
// starves beside the browser that draws it.
constexpr int kNice = 3;
// Work that lasts long enough for every helper to come.
constexpr int kTasks = 64;
constexpr std::chrono::milliseconds kTaskTime{1};

}  // namespace

void LowerThreadPriority() {
  // On Linux a thread has a priority of its own. To lower it is always allowed.
  const auto thread = static_cast<id_t>(syscall(SYS_gettid));
  setpriority(PRIO_PROCESS, thread, kNice);
}

void StartHelperThreads(int threads) {
  RunInArena(threads, [] {
    ParallelFor(kTasks, [](int) { std::this_thread::sleep_for(kTaskTime); });
  });
}

}  // namespace graspdb
