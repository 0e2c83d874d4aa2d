#pragma once

#include <functional>
#include <optional>
#include <utility>

namespace graspdb {

/** Runs `work` with at most so many threads, 0 meaning one per core. */
void RunInArena(int threads, const std::function<void()>& work);

/** The same for work that returns something. */
template <class Work>
auto RunWithThreads(int threads, const Work& work) {
  std::optional<decltype(work())> result;
  RunInArena(threads, [&] { result.emplace(work()); });
  return std::move(*result);
}

}  // namespace graspdb
