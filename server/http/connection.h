#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "server/http/limits.h"
#include "server/http/message_head.h"

namespace graspdb {

/** One accepted TCP connection, read message by message under the limits: what
 stands between the network and the HTTP library. All waiting is bounded.
 Used by one thread. */
class Connection {
 public:
  /** @param socket  Open, blocking; stays the caller's.
   @param stop_fd  Becomes readable when the server stops: idle waiting ends.
   @param limits  Outlives the connection. */
  Connection(int socket, int stop_fd, const HttpLimits& limits);

  /** Waits for the next request to begin.
   @returns false when it has not, in time or before the server stops. */
  bool AwaitMessage(std::chrono::milliseconds patience) const;

  struct Closed {};  ///< The client went away.

  /** Reads the head of a request. */
  std::variant<MessageHead, HeadFault, Closed> ReadHead();

  /** Reads bytes of the body after ReadHead(): never past its Content-Length,
   without end when it is chunked. Asks for the body first where the client
   waits for that (Expect: 100-continue).
   @returns the number of bytes, 0 at the end, -1 when the client is too slow or
     gone. */
  long ReadBody(char* bytes, size_t size);
  /** True when the next byte on the connection begins another request. */
  bool AtMessageEnd() const { return !chunked_ && remaining_ == 0; }
  /** True when ReadBody() failed because of the time it took. */
  bool timed_out() const { return timed_out_; }

  /** Sends all bytes. @returns whether it could. */
  bool Write(std::string_view bytes);
  /** Ends the sending side, then throws away what still arrives, so that the
   client gets to see the answer: until that has reached it, or the client goes.
   @param still_sending  The client may not look at the answer before it has
     sent what it was about to: only its going ends the wait. */
  void Linger(bool still_sending);

 private:
  using Clock = std::chrono::steady_clock;

  bool WaitReadable(Clock::time_point deadline, bool heed_stop) const;
  long Receive(char* bytes, size_t size, Clock::time_point deadline);
  /** Receives more into the buffer; false when there is no more. */
  bool FillBuffer(Clock::time_point deadline);

  const int socket_;
  const int stop_fd_;
  const HttpLimits& limits_;
  std::string buffer_;  ///< Received; empty when all of it is consumed.
  size_t consumed_{0};  ///< Of the buffer's bytes, the first so many.
  size_t remaining_{0};
  bool chunked_{false};
  bool expects_continue_{false};
  bool timed_out_{false};
  Clock::time_point body_deadline_{};
};

}  // namespace graspdb
