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
