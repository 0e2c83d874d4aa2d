#pragma once

#include <ctime>

namespace graspdb {

/** Seconds of processor time that the calling thread has used: for reports of
 what a computation took, never for what it decides. */
inline double ThreadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) +
         1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace graspdb
