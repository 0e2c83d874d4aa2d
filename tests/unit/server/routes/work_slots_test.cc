#include "server/routes/work_slots.h"

#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace graspdb {
namespace {

TEST(WorkSlots, NoMoreThanThereAreWorkAtOnce) {
  WorkSlots slots(2, 100);
  std::atomic<int> working{0};
  std::atomic<int> most{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 200; ++i) {
        const auto slot = slots.Take({});
        ASSERT_TRUE(slot);
        const int now = ++working;
        int before = most;
        while (before < now && !most.compare_exchange_weak(before, now)) {
        }
        --working;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_GE(most, 1);
  EXPECT_LE(most, 2);
}

TEST(WorkSlots, WhenTooManyWaitTheNextIsTurnedAway) {
  WorkSlots slots(1, 0);
  auto slot = slots.Take({});
  ASSERT_TRUE(slot);
  const auto refused = slots.Take({});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kOverloaded);
  slot->reset();
  EXPECT_TRUE(slots.Take({}));
}

TEST(WorkSlots, WhoeverWaitsHearsOfTheEnd) {
  WorkSlots slots(1, 1);
  const auto slot = slots.Take({});
  std::stop_source end;
  std::thread waiting([&] {
    const auto refused = slots.Take(end.get_token());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kOverloaded);
  });
  end.request_stop();
  waiting.join();
}

}  // namespace
}  // namespace graspdb
