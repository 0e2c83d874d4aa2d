#pragma once

#include <functional>
#include <string>

#include "server/records.h"

namespace graspdb {

/** Hears what becomes of jobs, from the threads that work on them; either may
 be empty. */
struct JobObserver {
  /** A job has ended, or was put back into the queue, after so many seconds of
   work. */
  std::function<void(const StoredJob& job, double seconds)> on_end;
  /** Something failed that no client is told of: the store, or a mistake of
   ours. */
  std::function<void(const std::string& job_id, const std::string& what)>
      on_failure;
};

}  // namespace graspdb
