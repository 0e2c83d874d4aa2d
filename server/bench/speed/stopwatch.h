#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "engine/base/thread_clock.h"
#include "server/codec/json.h"

namespace graspdb {

/** How long one call took, seconds. */
struct Timing {
  std::vector<double> samples;  ///< Seconds per call, each over `calls` calls.
  int64_t calls{1};
};

/** {"median", "lower", "upper", "samples", "calls"}: the median, the quartiles
 around it, how many times it was measured, each over how many calls. */
Json EncodeTiming(const Timing& timing);

double CalcMedian(const Timing& timing);

/** What was measured once. */
inline Timing MakeTiming(double seconds) { return {{seconds}, 1}; }

/** How a call is timed. */
struct StopwatchOptions {
  double seconds{0.5};  ///< In all, about; at least three samples are taken.
  int most_samples{25};
  bool wall{false};  ///< Not the calling thread's time but the wall clock's.
};

/** The wall clock, s. */
inline double Now() {
  return std::chrono::duration<double>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/** Times f(), which returns a number, so that its work cannot be left out. */
template <class F>
Timing TimeCalls(const F& f, const StopwatchOptions& options = {}) {
  constexpr double kShortest = 1e-3;  // Of a sample, s, for the clock's sake.
  constexpr size_t kFewest = 3;
  const auto read_clock = options.wall ? Now : ThreadSeconds;
  volatile double sink = 0.0;
  Timing timing;
  double spent = 0.0;
  while (true) {
    const double start = read_clock();
    for (int64_t i = 0; i < timing.calls; ++i)
      sink = sink + static_cast<double>(f());
    const double took = read_clock() - start;
    if (took < kShortest && timing.samples.empty()) {
      timing.calls *= took < 0.1 * kShortest ? 10 : 2;
      continue;
    }
    spent += took;
    timing.samples.push_back(took / static_cast<double>(timing.calls));
    const size_t count = timing.samples.size();
    if (count >= static_cast<size_t>(options.most_samples) ||
        (count >= kFewest && spent >= options.seconds)) {
      return timing;
    }
  }
}

}  // namespace graspdb
