#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "engine/base/result.h"
#include "server/http/limits.h"
#include "server/http/request_metrics.h"
#include "server/http/router.h"

namespace graspdb {

class Service;
struct ServerConfig;

/** Serves the whole API over HTTP until SIGTERM or SIGINT, then lets requests
 in flight end. Prints the address on standard output. Defined in
 server/routes/run_server.cc, which knows all routes.
 @returns the exit status: 0, or 2 when it cannot listen. */
int RunServer(Service& service, const ServerConfig& config);

/** Whether the configured address can be listened on, asked before a database
 is made for nothing. @retval kConflict in words when it cannot. */
Result<void> CheckAddress(const ServerConfig& config);

struct HttpServerOptions {
  HttpLimits limits;
  size_t threads{64};  ///< Connections served at the same time.
  /** Receives one line, without line break, per answer and per event. Called
   from many threads at once. */
  std::function<void(const std::string&)> log;
  /** Counts the requests; may be null. */
  std::shared_ptr<RequestMetrics> metrics;
};

/** Answers HTTP/1.1 requests from a Router. The only user of the HTTP library,
 which it feeds with checked messages only. Problems are RFC 9457; an exception
 in a handler is a 500 that tells nothing but the request id. */
class HttpServer {
 public:
  HttpServer(Router router, HttpServerOptions options);
  ~HttpServer();

  /** Opens the listening socket.
   @param port  0: any free one.
   @returns the port. @retval kConflict when it cannot listen there. */
  Result<int> Bind(const std::string& host, int port);
  /** Serves until Stop(). @pre Bind() succeeded.
   @retval kConflict when it lost its socket and cannot listen again. */
  Result<void> Serve();
  /** Refuses new connections and lets requests in flight end; HttpRequest::stop
   asks handlers that wait to answer now. Any thread, any time. */
  void Stop();
  /** Ends every connection at once, however slow its client: for when those in
   flight have had time enough. Any thread, after Stop(). */
  void CutConnections();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspdb
