#include "engine/base/parallel.h"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace graspdb {
namespace {

TEST(ParallelFor, CallsEveryIndexOnceAndItsWritesAreThereAfterwards) {
  std::vector<int> calls(1000);
  ParallelFor(1000, [&](int i) { ++calls[i]; });
  EXPECT_EQ(calls, std::vector<int>(1000, 1));
}

TEST(ParallelFor, Nests) {
  std::vector<int> sums(50);
  ParallelFor(50, [&](int i) {
    std::vector<int> terms(i);
    ParallelFor(i, [&](int j) { terms[j] = j; });
    for (const int term : terms) sums[i] += term;
  });
  for (int i = 0; i < 50; ++i) EXPECT_EQ(sums[i], i * (i - 1) / 2);
}

TEST(ParallelFor, OfNothingCallsNothing) {
  ParallelFor(0, [](int) { FAIL(); });
}

TEST(RunWithThreads, OfOneThreadStaysOnOneThread) {
  const bool one = RunWithThreads(1, [] {
    const std::thread::id mine = std::this_thread::get_id();
    std::vector<char> same(200);
    ParallelFor(200,
                [&](int i) { same[i] = std::this_thread::get_id() == mine; });
    return same == std::vector<char>(200, 1);
  });
  EXPECT_TRUE(one);
}

}  // namespace
}  // namespace graspdb
