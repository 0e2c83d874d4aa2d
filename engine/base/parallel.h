#pragma once

#include <functional>
#include <optional>
#include <utility>

namespace graspdb {

/**
 * Calls body(i) for every i in [0, count), on the threads that the caller may
 * use, in no particular order. Loops may nest. What body(i) writes must be
 * nobody else's; it is there for the caller afterwards.
 */
void ParallelFor(int count, const std::function<void(int)>& body);

/** Whether what a body does is still wanted; any thread may ask. */
using Wanted = std::function<bool()>;

/**
 * Calls body(i, wanted) for i = 0, 1, … below count, begun in that order, on
 * the threads that the caller may use, and is_last(i) in that order, one at a
 * time, each once the bodies up to i have ended. The first i for which that is
 * true is the last: the answer does not depend on the number of threads, though
 * bodies beyond it may have been called. Those that still run are no longer
 * wanted.
 * @returns how many indices that are: i + 1, or count.
 */
int ParallelUntil(int count,
                  const std::function<void(int, const Wanted&)>& body,
                  const std::function<bool(int)>& is_last);

/** Runs `work` with at most so many threads, 0 meaning one per core. */
void RunInArena(int threads, const std::function<void()>& work);

/** The same for work that returns something. */
template <class Work>
auto RunWithThreads(int threads, const Work& work) {
  std::optional<decltype(work())> result;
  RunInArena(threads, [&] { result.emplace(work()); });
  return std::move(*result);
}

/** How many threads the caller may use. */
int CountThreads();

}  // namespace graspdb
