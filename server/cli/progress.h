#pragma once

#include <chrono>
#include <string>

namespace graspdb {

/** Tells a person on standard error how far a long work is: a bar that moves on
 a terminal, a line per stage in a pipe after the first second, nothing when it
 is quiet. */
class Progress {
 public:
  explicit Progress(bool quiet);
  /** Ends the bar's line. */
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /** @param share  Of the whole work, 0..1. */
  void Report(const std::string& stage, double share);
  /** A line of its own, above the bar. */
  void Say(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;
  void Draw(const std::string& stage, double share);

  bool quiet_;
  bool terminal_;
  bool bar_shown_{false};
  std::string last_stage_;
  Clock::time_point started_{Clock::now()};
  Clock::time_point last_drawn_{};
};

}  // namespace graspdb
