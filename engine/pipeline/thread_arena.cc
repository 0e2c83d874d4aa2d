#include "engine/pipeline/thread_arena.h"

#include <tbb/task_arena.h>

namespace graspdb {

void RunInArena(int threads, const std::function<void()>& work) {
  tbb::task_arena arena(
      threads > 0 ? threads : static_cast<int>(tbb::task_arena::automatic));
  arena.execute(work);
}

}  // namespace graspdb
