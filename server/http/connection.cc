#include "server/http/connection.h"

#include <linux/sockios.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include <fmt/format.h>

namespace graspdb {
namespace {

using Clock = std::chrono::steady_clock;

int CalcMillisecondsUntil(Clock::time_point deadline) {
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
  return static_cast<int>(std::max<int64_t>(0, left.count()));
}

}  // namespace

Connection::Connection(int socket, int stop_fd, const HttpLimits& limits)
    : socket_(socket), stop_fd_(stop_fd), limits_(limits) {}

bool Connection::WaitReadable(Clock::time_point deadline,
                              bool heed_stop) const {
  std::array<pollfd, 2> files{{{socket_, POLLIN, 0}, {stop_fd_, POLLIN, 0}}};
  for (;;) {
    const int ready =
        poll(files.data(), heed_stop ? 2 : 1, CalcMillisecondsUntil(deadline));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return false;
    return files[0].revents != 0;
  }
}

long Connection::Receive(char* bytes, size_t size, Clock::time_point deadline) {
  if (!WaitReadable(deadline, false)) {
    timed_out_ = true;
    return -1;
  }
  for (;;) {
    const ssize_t count = recv(socket_, bytes, size, 0);
    if (count >= 0 || errno != EINTR) return count;
  }
}

bool Connection::FillBuffer(Clock::time_point deadline) {
  std::array<char, 8192> bytes;
  const long count = Receive(bytes.data(), bytes.size(), deadline);
  if (count > 0) buffer_.append(bytes.data(), static_cast<size_t>(count));
  return count > 0;
}

bool Connection::AwaitMessage(std::chrono::milliseconds patience) const {
  return consumed_ < buffer_.size() ||
         WaitReadable(Clock::now() + patience, true);
}

std::variant<MessageHead, HeadFault, Connection::Closed>
Connection::ReadHead() {
  buffer_.erase(0, std::exchange(consumed_, 0));
  const auto deadline = Clock::now() + limits_.head_timeout;
  size_t searched = 0;
  size_t end = std::string::npos;
  while ((end = buffer_.find("\r\n\r\n", searched)) == std::string::npos) {
    searched = buffer_.size() - std::min<size_t>(buffer_.size(), 3);
    if (buffer_.size() > limits_.max_head_bytes) {
      return HeadFault{HttpFault::kHeaderFieldsTooLarge,
                       fmt::format("A request head has at most {} bytes.",
                                   limits_.max_head_bytes)};
    }
    if (FillBuffer(deadline)) continue;
    if (!timed_out_ || buffer_.empty()) return Closed{};
    return HeadFault{
        HttpFault::kRequestTimeout,
        fmt::format("The request head took more than {:g} s.",
                    1e-3 * static_cast<double>(limits_.head_timeout.count()))};
  }
  auto parsed =
      ParseHead(std::string_view(buffer_).substr(0, end + 4), limits_);
  buffer_.erase(0, end + 4);
  if (auto* fault = std::get_if<HeadFault>(&parsed)) return std::move(*fault);
  auto& head = std::get<MessageHead>(parsed);
  chunked_ = head.chunked;
  remaining_ = head.content_length;
  const auto expect = head.fields.find("expect");
  expects_continue_ = head.HasBody() && expect != head.fields.end() &&
                      expect->second == "100-continue";
  body_deadline_ = Clock::now() + limits_.body_timeout;
  return std::move(head);
}

long Connection::ReadBody(char* bytes, size_t size) {
  if (!chunked_) size = std::min(size, remaining_);
  if (size == 0) return 0;
  if (expects_continue_) {
    expects_continue_ = false;
    if (!Write("HTTP/1.1 100 Continue\r\n\r\n")) return -1;
  }
  long count = 0;
  if (buffer_.empty() && size >= 4096) {
    count = Receive(bytes, size, body_deadline_);
  } else {
    if (buffer_.empty() && !FillBuffer(body_deadline_)) return -1;
    count = static_cast<long>(buffer_.copy(bytes, size, consumed_));
    consumed_ += static_cast<size_t>(count);
    if (consumed_ == buffer_.size()) {
      buffer_.clear();
      consumed_ = 0;
    }
  }
  if (count <= 0) return -1;  // The client ended in the middle of a body.
  if (!chunked_) remaining_ -= static_cast<size_t>(count);
  return count;
}

bool Connection::Write(std::string_view bytes) {
  const auto deadline =
      Clock::now() + limits_.write_timeout +
      std::chrono::seconds(bytes.size() / limits_.least_bytes_per_second);
  while (!bytes.empty()) {
    const ssize_t count =
        send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count > 0) {
      bytes.remove_prefix(static_cast<size_t>(count));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return false;
    pollfd file{socket_, POLLOUT, 0};
    const auto patience = std::min<int64_t>(
        std::chrono::milliseconds(limits_.write_timeout).count(),
        CalcMillisecondsUntil(deadline));
    if (poll(&file, 1, static_cast<int>(patience)) == 0) return false;
  }
  return true;
}

void Connection::Linger(bool still_sending) {
  constexpr size_t kMostDiscarded = 64 << 20;
  constexpr std::chrono::milliseconds kStep{2};
  shutdown(socket_, SHUT_WR);
  const auto deadline = Clock::now() + limits_.linger_timeout;
  std::array<char, 16384> bytes;
  for (size_t discarded = 0;
       discarded < kMostDiscarded && Clock::now() < deadline;) {
    int unsent = 0;
    if (!still_sending && ioctl(socket_, SIOCOUTQ, &unsent) == 0 &&
        unsent == 0) {
      return;
    }
    if (!WaitReadable(Clock::now() + kStep, false)) continue;
    const ssize_t count = recv(socket_, bytes.data(), bytes.size(), 0);
    if (count == 0 || (count < 0 && errno != EINTR)) return;
    discarded += static_cast<size_t>(std::max<ssize_t>(0, count));
  }
}

}  // namespace graspdb
