#pragma once

#include <memory>
#include <string>

#include "server/lru_cache.h"
#include "server/records.h"

namespace graspdb {

/** Stored grasps as JSON, remembered: writing them takes longer than finding
 them. A stored grasp changes in nothing but what a simulator found. */
class GraspTexts {
 public:
  /** ToJson() of the grasp. */
  std::shared_ptr<const std::string> Get(const StoredGrasp& grasp,
                                         const HandModel& hand);

  CacheCounts counts() const { return cache_.counts(); }

 private:
  static constexpr int64_t kMostBytes = int64_t{32} << 20;

  LruCache<std::shared_ptr<const std::string>> cache_{kMostBytes};
};

}  // namespace graspdb
