#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace graspdb {

/** How many bytes of uploads a server holds in memory at once. Thread-safe. */
class BodyBudget {
 public:
  explicit BodyBudget(size_t bytes)
      : left_(static_cast<int64_t>(std::min(bytes, kMost))) {}
  BodyBudget(const BodyBudget&) = delete;

 private:
  friend class HeldBody;
  static constexpr size_t kMost = size_t{1} << 60;

  std::atomic<int64_t> left_;
};

/** What one body holds of a budget, which must outlive it; given back at its
 end. */
class HeldBody {
 public:
  explicit HeldBody(BodyBudget& budget) : budget_(budget) {}
  HeldBody(const HeldBody&) = delete;
  ~HeldBody() { budget_.left_ += held_; }

  /** The body has so many bytes now. The first 64 KiB are free: what asks for
   little is not kept out by others' uploads.
   @returns false when the budget has not as many. */
  bool Grow(size_t size) {
    constexpr int64_t kFree = 64 << 10;
    const int64_t more = static_cast<int64_t>(size) - kFree - held_;
    if (more <= 0) return true;
    held_ += more;
    return (budget_.left_ -= more) >= 0;
  }

 private:
  BodyBudget& budget_;
  int64_t held_{0};
};

}  // namespace graspdb
