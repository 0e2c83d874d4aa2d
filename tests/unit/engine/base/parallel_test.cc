#include "engine/base/parallel.h"

#include <atomic>
#include <numeric>
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

TEST(ParallelUntil, EndsAtTheSameIndexOnAnyNumberOfThreads) {
  for (const int threads : {1, 2, 4}) {
    std::vector<int> bodies(200);
    std::vector<int> checked;
    const int count = RunWithThreads(threads, [&] {
      return ParallelUntil(
          200, [&](int i, const Wanted&) { bodies[i] = i * i; },
          [&](int i) {
            EXPECT_EQ(bodies[i], i * i);  // Its body has ended.
            checked.push_back(i);
            return i == 120;
          });
    });
    EXPECT_EQ(count, 121);
    std::vector<int> expected(121);
    std::iota(expected.begin(), expected.end(), 0);
    EXPECT_EQ(checked, expected);
  }
}

TEST(ParallelUntil, BeginsFewBodiesBeyondTheLast) {
  std::atomic<int> bodies{0};
  RunWithThreads(1, [&] {
    return ParallelUntil(
        100, [&](int, const Wanted&) { ++bodies; },
        [](int i) { return i == 9; });
  });
  EXPECT_EQ(bodies, 10);
}

TEST(ParallelUntil, WhatRunsBeyondTheLastIsNoLongerWanted) {
  // The second body waits for the first to be the last.
  const int count = RunWithThreads(2, [] {
    return ParallelUntil(
        2,
        [](int i, const Wanted& wanted) {
          EXPECT_TRUE(i == 1 || wanted());
          while (i == 1 && wanted()) std::this_thread::yield();
        },
        [](int) { return true; });
  });
  EXPECT_EQ(count, 1);
}

TEST(ParallelUntil, CallsAllWhenNoneIsTheLast) {
  EXPECT_EQ(ParallelUntil(
                5, [](int, const Wanted&) {}, [](int) { return false; }),
            5);
  EXPECT_EQ(
      ParallelUntil(
          0, [](int, const Wanted&) { FAIL(); }, [](int) { return true; }),
      0);
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
