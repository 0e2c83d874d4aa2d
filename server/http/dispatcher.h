#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "server/http/body_budget.h"
#include "server/http/limits.h"
#include "server/http/message.h"
#include "server/http/message_head.h"
#include "server/http/request_body.h"
#include "server/http/router.h"

namespace graspdb {

/** For the log, of what is thrown and is no std::exception. */
inline constexpr char kUnknownException[] = "unknown exception";

/** What a request is answered: finds its route, reads its body, calls the
 handler and makes problems of all that goes wrong. Knows neither sockets nor
 the HTTP library. Thread-safe. */
class Dispatcher {
 public:
  /** @param log  Receives one line per failure that is the server's. */
  Dispatcher(Router router, const HttpLimits& limits,
             std::function<void(const std::string&)> log);

  /** A request whose head has been read. */
  struct Request {
    const MessageHead& head;
    std::string id;
    BodySource body;          ///< Asked when an operation takes one.
    bool on_loopback{false};  ///< The server listens on this machine only.
    bool turned_away{false};  ///< Only vital routes are answered.
    std::stop_token stop;     ///< The server stops: see HttpRequest::stop.
  };
  struct Answer {
    HttpResponse response;
    std::string pattern;  ///< Of the route; "" for none.
  };
  /** Never throws what a handler throws: that is a 500 which tells nothing but
   the request's id. */
  Answer Dispatch(const Request& request);
  /** The 503 for whom there is no thread. @param id  Of the request. */
  static Answer TurnAway(const std::string& id);

  /** Tells the log of a bug. @param id  Of the request, or "". */
  void LogInternal(const std::string& id, const std::string& cause) const;

 private:
  HttpResponse Call(const Route& route, const Request& request,
                    HttpRequest& decoded);

  const Router router_;
  const HttpLimits limits_;
  const std::function<void(const std::string&)> log_;
  BodyBudget budget_;
};

}  // namespace graspdb
