#pragma once

#include <cstdint>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include "engine/base/contract.h"

namespace graspdb {

/** How a cache has done since the program started. */
struct CacheCounts {
  int64_t hits{0};
  int64_t misses{0};
  int64_t bytes{0};  ///< What is remembered takes.
};

/** Values by key; when they take more than so many bytes, those go that nobody
 asked for the longest. A value is copied out: let it be a shared_ptr or small.
 Thread-safe. */
template <class Value>
class LruCache {
 public:
  explicit LruCache(int64_t max_bytes) : max_bytes_(max_bytes) {}

  std::optional<Value> Find(const std::string& key) {
    const std::lock_guard lock(mutex_);
    const auto found = places_.find(key);
    if (found == places_.end()) {
      ++counts_.misses;
      return std::nullopt;
    }
    ++counts_.hits;
    entries_.splice(entries_.begin(), entries_, found->second);
    return found->second->value;
  }

  /** Replaces what is there. What is larger than the whole cache is not kept.
   @param bytes  That the value takes, about; the key's are added. */
  void Insert(const std::string& key, Value value, int64_t bytes) {
    GRASPDB_EXPECTS(bytes >= 0);
    const std::lock_guard lock(mutex_);
    if (const auto found = places_.find(key); found != places_.end()) {
      Remove(found->second);
    }
    const int64_t size = bytes + 2 * static_cast<int64_t>(key.size());
    if (size > max_bytes_) return;
    entries_.push_front({key, std::move(value), size});
    places_[key] = entries_.begin();
    counts_.bytes += size;
    while (counts_.bytes > max_bytes_) Remove(std::prev(entries_.end()));
  }

  CacheCounts counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
  }

 private:
  struct Entry {
    std::string key;
    Value value;
    int64_t bytes;
  };
  using Place = typename std::list<Entry>::iterator;

  void Remove(Place place) {
    counts_.bytes -= place->bytes;
    places_.erase(place->key);
    entries_.erase(place);
  }

  const int64_t max_bytes_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  // Those asked for last come first.
  std::unordered_map<std::string, Place> places_;
  CacheCounts counts_;
};

}  // namespace graspdb
