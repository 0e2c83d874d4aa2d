#include "server/lru_cache.h"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace graspdb {
namespace {

TEST(LruCache, FindsWhatWasInsertedLast) {
  LruCache<int> cache(1000);
  EXPECT_FALSE(cache.Find("a"));
  cache.Insert("a", 1, 10);
  cache.Insert("a", 2, 20);
  EXPECT_EQ(cache.Find("a"), 2);
  const CacheCounts counts = cache.counts();
  EXPECT_EQ(counts.hits, 1);
  EXPECT_EQ(counts.misses, 1);
  EXPECT_EQ(counts.bytes, 22);  // The key counts twice.
}

TEST(LruCache, ForgetsFirstWhatNobodyAskedForTheLongest) {
  LruCache<int> cache(36);
  for (const char* key : {"a", "b", "c"}) cache.Insert(key, key[0], 10);
  EXPECT_TRUE(cache.Find("a"));
  cache.Insert("d", 'd', 10);
  EXPECT_FALSE(cache.Find("b"));
  for (const char* key : {"a", "c", "d"}) {
    EXPECT_EQ(cache.Find(key), key[0]) << key;
  }
  EXPECT_EQ(cache.counts().bytes, 36);
}

TEST(LruCache, KeepsNothingThatIsLargerThanItself) {
  LruCache<int> cache(100);
  cache.Insert("small", 1, 10);
  cache.Insert("large", 2, 200);
  EXPECT_FALSE(cache.Find("large"));
  EXPECT_TRUE(cache.Find("small"));
  // Not even where something smaller was.
  cache.Insert("small", 3, 200);
  EXPECT_FALSE(cache.Find("small"));
  EXPECT_EQ(cache.counts().bytes, 0);
}

TEST(LruCache, ManyThreadsStayWithinTheLimit) {
  LruCache<int> cache(500);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&cache, t] {
      for (int i = 0; i < 2000; ++i) {
        const int n = (i * 7 + t) % 100;
        const std::string key = std::to_string(n);
        if (const auto value = cache.Find(key)) {
          EXPECT_EQ(*value, n);
        } else {
          cache.Insert(key, n, 20);
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const CacheCounts counts = cache.counts();
  EXPECT_LE(counts.bytes, 500);
  EXPECT_EQ(counts.hits + counts.misses, 8000);
}

}  // namespace
}  // namespace graspdb
