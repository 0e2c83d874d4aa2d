#pragma once

#include <memory>
#include <string>

#include "server/jobs/service.h"
#include "server/lru_cache.h"

namespace graspdb {

/** Stored grasps as JSON, remembered: reading and writing them takes longer
 than finding them. A stored grasp changes in nothing but what a simulator
 found. */
class GraspTexts {
 public:
  /** ToJson() of the grasp.
   @retval kNotFound when it is gone. */
  Result<std::shared_ptr<const std::string>> Get(const GraspKey& key,
                                                 const Service& service);

  CacheCounts counts() const { return cache_.counts(); }

 private:
  static constexpr int64_t kMostBytes = int64_t{32} << 20;

  LruCache<std::shared_ptr<const std::string>> cache_{kMostBytes};
};

}  // namespace graspdb
