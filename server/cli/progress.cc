#include "server/cli/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

namespace graspdb {
namespace {

constexpr int kBarWidth = 24;
constexpr std::chrono::milliseconds kRedraw{100};  // Of a bar.
constexpr std::chrono::seconds kRepeat{10};        // Of a line in a pipe.
constexpr std::chrono::seconds kQuietStart{1};     // No line in a pipe before.

}  // namespace

Progress::Progress(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (bar_shown_) fmt::print(stderr, "\r\033[K");
}

void Progress::Report(const std::string& stage, double share) {
  if (quiet_) return;
  const auto now = Clock::now();
  const bool new_stage = stage != last_stage_;
  if (!terminal_ && now - started_ < kQuietStart) return;
  if (terminal_) {
    if (now - last_drawn_ < kRedraw && share < 1.0) return;
  } else if (!new_stage && now - last_drawn_ < kRepeat) {
    return;
  }
  last_drawn_ = now;
  last_stage_ = stage;
  Draw(stage, std::clamp(share, 0.0, 1.0));
}

void Progress::Draw(const std::string& stage, double share) {
  const int percent = static_cast<int>(100.0 * share);
  if (!terminal_) {
    fmt::print(stderr, "{:3} %  {}\n", percent, stage);
    return;
  }
  const auto filled = static_cast<size_t>(kBarWidth * share);
  const std::string bar =
      std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  fmt::print(stderr, "\r\033[K[{}] {:3} %  {:.60}", bar, percent, stage);
  std::fflush(stderr);
  bar_shown_ = true;
}

void Progress::Say(const std::string& line) {
  if (quiet_) return;
  if (bar_shown_) fmt::print(stderr, "\r\033[K");
  fmt::print(stderr, "{}\n", line);
}

}  // namespace graspdb
