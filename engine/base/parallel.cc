#include "engine/base/parallel.h"

#include <atomic>
#include <mutex>
#include <vector>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

// oneTBB is not built for ThreadSanitizer, which therefore sees neither how a
// loop's threads start nor how they end. This file, the only one that wraps
// oneTBB, is itself kept out of its sight and tells it.
#ifdef GRASPDB_THREAD_SANITIZER
extern "C" {
void __tsan_acquire(void* address);
void __tsan_release(void* address);
}
#endif

namespace graspdb {
namespace {

// Orders what happened before Leave() before what follows Enter().
class Gate {
 public:
#ifdef GRASPDB_THREAD_SANITIZER
  void Leave() { __tsan_release(this); }
  void Enter() { __tsan_acquire(this); }

 private:
  char address_ = 0;
#else
  void Leave() {}
  void Enter() {}
#endif
};

}  // namespace

void ParallelFor(int count, const std::function<void(int)>& body) {
  Gate fork, join;
  fork.Leave();
  tbb::parallel_for(0, count, [&](int i) {
    fork.Enter();
    body(i);
    join.Leave();
  });
  join.Enter();
}

int ParallelUntil(int count,
                  const std::function<void(int, const Wanted&)>& body,
                  const std::function<bool(int)>& is_last) {
  std::mutex mutex;
  std::vector<bool> done(static_cast<size_t>(count));
  std::atomic<int> end = count;
  int begun = 0, checked = 0;
  ParallelFor(CountThreads(), [&](int) {
    std::unique_lock lock(mutex);
    while (begun < end) {
      const int i = begun++;
      lock.unlock();
      body(i, [&end, i] { return i < end; });
      lock.lock();
      done[static_cast<size_t>(i)] = true;
      for (; checked < end && done[static_cast<size_t>(checked)]; ++checked) {
        if (is_last(checked)) end = checked + 1;
      }
    }
  });
  return end;
}

void RunInArena(int threads, const std::function<void()>& work) {
  Gate fork, join;
  fork.Leave();
  tbb::task_arena arena(
      threads > 0 ? threads : static_cast<int>(tbb::task_arena::automatic));
  arena.execute([&] {
    fork.Enter();
    work();
    join.Leave();
  });
  join.Enter();
}

int CountThreads() { return tbb::this_task_arena::max_concurrency(); }

}  // namespace graspdb
