#include "server/http/http_server.h"

#include <fcntl.h>
#include <httplib.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <mutex>
#include <random>
#include <set>
#include <stop_token>
#include <utility>

#include <fmt/format.h>

#include "server/http/connection.h"
#include "server/http/dispatcher.h"
#include "server/http/log_line.h"
#include "server/http/problem.h"
#include "server/http/site.h"

namespace graspdb {
namespace {

using Clock = std::chrono::steady_clock;

/** One request on its way through the server. */
struct Exchange {
  Connection* connection{nullptr};
  MessageHead head;
  std::optional<HeadFault> fault;  ///< Instead of the head.
  bool unheard{false};  ///< Turned away before it said what it wants.
  std::string id;
  std::string pattern;  ///< Of the route that answered.
  Clock::time_point begin{Clock::now()};
  int status{0};
  size_t bytes_in{0};
  size_t bytes_out{0};
  bool close{false};  ///< The connection ends after this exchange.
};

/** The exchange of this thread: the library hands its handlers nothing of
 ours. */
thread_local Exchange* current_exchange = nullptr;

/** Lets the library read a checked, minimal head and then the body. */
class LibraryStream final : public httplib::Stream {
 public:
  LibraryStream(std::string head, Connection& connection)
      : head_(std::move(head)), connection_(connection) {}

  using httplib::Stream::write;
  bool is_readable() const override { return true; }
  bool is_writable() const override { return true; }
  ssize_t read(char* bytes, size_t size) override {
    if (position_ == head_.size()) return ReadBody(bytes, size);
    const size_t count = head_.copy(bytes, size, position_);
    position_ += count;
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* bytes, size_t size) override {
    return connection_.Write({bytes, size}) ? static_cast<ssize_t>(size) : -1;
  }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  /** The library only compares it with the greatest that select() takes; we
   poll(). */
  socket_t socket() const override { return 0; }

 private:
  // The library reads a line between two chunks byte by byte, and keeps it
  // however long it is.
  ssize_t ReadBody(char* bytes, size_t size) {
    constexpr size_t kLongestLine = 4096;
    const long count = connection_.ReadBody(bytes, size);
    const bool in_line = size == 1 && count == 1 && *bytes != '\n';
    line_bytes_ = in_line ? line_bytes_ + 1 : 0;
    return line_bytes_ > kLongestLine ? -1 : count;
  }

  std::string head_;
  size_t position_{0};
  size_t line_bytes_{0};
  Connection& connection_;
};

/** What the library gets to see of a request: how to frame it, no more. Ranges,
 codings, forms and the like never reach it. */
std::string MakeLibraryHead(const MessageHead& head) {
  if (head.chunked) {
    return "POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n";
  }
  if (head.content_length > 0) {
    return fmt::format("POST / HTTP/1.1\r\nContent-Length: {}\r\n\r\n",
                       head.content_length);
  }
  return head.method == "HEAD" ? "HEAD / HTTP/1.1\r\n\r\n"
                               : "GET / HTTP/1.1\r\n\r\n";
}

bool IsUsableRequestId(const std::string& id) {
  return !id.empty() && id.size() <= 64 &&
         id.find_first_not_of(
             "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnop"
             "qrstuvwxyz0123456789-_.") == std::string::npos;
}

std::string MakeRequestId() {
  static const uint32_t run = std::random_device()();
  static std::atomic<uint32_t> count{0};
  return fmt::format("{:08x}-{:08x}", run, ++count);
}

/** @param reader  Null when the library takes the request for one without a
 body. */
BodyEnd ReadAll(Exchange& exchange, const httplib::ContentReader* reader,
                const BodyTaker& take) {
  const auto count = [&](const char* bytes, size_t size) {
    exchange.bytes_in += size;
    return take({bytes, size});
  };
  if (reader != nullptr && (*reader)(count)) return BodyEnd::kWhole;
  return exchange.connection->timed_out() ? BodyEnd::kTimedOut
                                          : BodyEnd::kBroken;
}

double CalcMilliseconds(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin)
      .count();
}

/** What a connection is for this thread, which may have no time for it. */
enum class Welcome { kServed, kTurnedAway, kDropped };
thread_local Welcome current_welcome = Welcome::kServed;

/** The threads that serve connections and the line of those that wait for one.
 When it is long the next are told so by another thread, and when that has too
 much to do, too, they are closed without a word. */
class ConnectionQueue final : public httplib::TaskQueue {
 public:
  /** @param line  How many may wait, and how many to be turned away. */
  ConnectionQueue(size_t threads, size_t line)
      : line_(line), served_(threads), turned_away_(1) {}

  void enqueue(std::function<void()> serve) override {
    if (!Put(served_, Welcome::kServed, serve) &&
        !Put(turned_away_, Welcome::kTurnedAway, serve)) {
      current_welcome = Welcome::kDropped;
      serve();
    }
  }
  void shutdown() override {
    served_.pool.shutdown();
    turned_away_.pool.shutdown();
  }
  /** Whether someone waits because all threads are taken. */
  bool IsCrowded() const { return served_.inside > served_.threads; }

 private:
  struct Room {
    explicit Room(size_t count) : threads(count), pool(count) {}
    const size_t threads;
    std::atomic<size_t> inside{0};  // With a thread, or waiting for one.
    httplib::ThreadPool pool;
  };

  bool Put(Room& room, Welcome welcome, std::function<void()>& serve) const {
    if (room.inside >= room.threads + line_) return false;
    ++room.inside;
    room.pool.enqueue([&room, welcome, serve = std::move(serve)] {
      current_welcome = welcome;
      serve();
      --room.inside;
    });
    return true;
  }

  const size_t line_;
  Room served_;
  Room turned_away_;
};

}  // namespace

struct HttpServer::Impl : httplib::Server {
  Impl(Router router, HttpServerOptions options_in)
      : options(std::move(options_in)),
        dispatcher(std::move(router), options.limits, options.log) {}
  ~Impl() override {
    close(stop_fd);
    // The library closes the socket at the end of serving, and only then.
    if (bound_unserved) close(svr_sock_);
  }

  // The library's one virtual step per connection.
  bool process_and_close_socket(socket_t socket) override;

  Result<int> Bind(const std::string& on_host, int on_port);
  void RequestStop();
  void CutConnections();
  void ServeConnection(socket_t socket);
  bool AwaitMessage(const Connection& connection,
                    std::chrono::milliseconds patience) const;
  void ServeExchange(Connection& connection, Exchange& exchange);
  void Answer(const httplib::ContentReader* reader, httplib::Response& out);
  void Stream(HttpResponse response, Exchange& exchange,
              httplib::Response& out);
  HttpResponse Respond(Exchange& exchange,
                       const httplib::ContentReader* reader);
  bool IsCrowded() const {
    const ConnectionQueue* const now = queue;
    return now != nullptr && now->IsCrowded();
  }
  void Log(const std::string& line) const {
    if (options.log) options.log(line);
  }
  HttpServerOptions options;
  Dispatcher dispatcher;
  std::mutex sockets_mutex;
  std::set<socket_t> sockets;  // Of the connections that are served.
  bool cut{false};             // Those, and all that come, end.
  std::string host;
  int port{0};
  bool bound_unserved{false};
  std::stop_source stop;
  const int stop_fd{eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
  // The library's, while it serves.
  std::atomic<const ConnectionQueue*> queue{nullptr};
};

Result<int> HttpServer::Impl::Bind(const std::string& on_host, int on_port) {
  errno = 0;
  const bool any = on_port == 0;
  const int bound = any                              ? bind_to_any_port(on_host)
                    : bind_to_port(on_host, on_port) ? on_port
                                                     : -1;
  if (bound > 0) {
    ::listen(svr_sock_, 512);  // The library's backlog of 5 drops bursts.
    bound_unserved = true;
    host = on_host;
    port = bound;
    return bound;
  }
  const std::string why =
      errno == 0 ? "the host is unknown" : std::strerror(errno);
  return Error{
      ErrorCode::kConflict,
      fmt::format("Cannot listen on {}:{}: {}.", on_host, on_port, why),
      "Stop the program that uses the port, or choose another with "
      "--port (0: any free one)."};
}

void HttpServer::Impl::RequestStop() {
  stop.request_stop();
  eventfd_write(stop_fd, 1);
  // Ends accept(), now or when it is called, unlike the library's own stop().
  shutdown(svr_sock_, SHUT_RDWR);
}

void HttpServer::Impl::CutConnections() {
  const std::lock_guard lock(sockets_mutex);
  cut = true;
  // Whoever reads or writes there is told that the client has gone.
  for (const socket_t socket : sockets) shutdown(socket, SHUT_RDWR);
}

bool HttpServer::Impl::process_and_close_socket(socket_t socket) {
  fcntl(socket, F_SETFD, FD_CLOEXEC);
  {
    const std::lock_guard lock(sockets_mutex);
    sockets.insert(socket);
    if (cut) shutdown(socket, SHUT_RDWR);
  }
  try {
    if (current_welcome != Welcome::kDropped) {
      ServeConnection(socket);
    } else if (options.metrics) {
      options.metrics->AddDropped();
    }
  } catch (const std::exception& exception) {  // Say, for want of memory.
    dispatcher.LogInternal("", exception.what());
    current_exchange = nullptr;
  } catch (...) {
    dispatcher.LogInternal("", kUnknownException);
    current_exchange = nullptr;
  }
  {
    const std::lock_guard lock(sockets_mutex);
    sockets.erase(socket);
  }
  shutdown(socket, SHUT_RDWR);
  close(socket);
  return true;
}

void HttpServer::Impl::ServeConnection(socket_t socket) {
  const bool turned_away = current_welcome == Welcome::kTurnedAway;
  HttpLimits limits = options.limits;
  if (turned_away) {
    limits.idle_timeout = limits.head_timeout = limits.linger_timeout =
        limits.turned_away_timeout;
  }
  Connection connection(socket, stop_fd, limits);
  for (size_t count = 1;; ++count) {
    const bool unheard = !AwaitMessage(connection, limits.idle_timeout);
    if (unheard && !turned_away) break;
    auto head = unheard ? MessageHead() : connection.ReadHead();
    if (std::holds_alternative<Connection::Closed>(head)) break;
    Exchange exchange;
    exchange.connection = &connection;
    exchange.unheard = unheard;
    if (const auto* fault = std::get_if<HeadFault>(&head)) {
      exchange.fault = *fault;
      exchange.close = true;
    } else {
      exchange.head = std::get<MessageHead>(std::move(head));
      const auto& fields = exchange.head.fields;
      const auto wish = fields.find("connection");
      exchange.close = stop.stop_requested() || turned_away ||
                       exchange.head.http_1_0 || exchange.head.chunked ||
                       count == options.limits.max_requests_per_connection ||
                       (wish != fields.end() && wish->second == "close");
    }
    ServeExchange(connection, exchange);
    if (exchange.close) {
      connection.Linger(exchange.fault || !connection.AtMessageEnd());
      break;
    }
  }
}

bool HttpServer::Impl::AwaitMessage(const Connection& connection,
                                    std::chrono::milliseconds patience) const {
  const std::chrono::milliseconds step = options.limits.crowded_idle_timeout;
  for (; patience > step; patience -= step) {
    if (connection.AwaitMessage(step)) return true;
    if (IsCrowded() || stop.stop_requested()) return false;
  }
  return connection.AwaitMessage(patience);
}

void HttpServer::Impl::ServeExchange(Connection& connection,
                                     Exchange& exchange) {
  const auto found = exchange.head.fields.find("x-request-id");
  exchange.id =
      found != exchange.head.fields.end() && IsUsableRequestId(found->second)
          ? found->second
          : MakeRequestId();
  current_exchange = &exchange;
  if (options.metrics) options.metrics->Begin();
  LibraryStream stream(MakeLibraryHead(exchange.head), connection);
  bool closed = false;
  const bool sent = process_request(stream, false, closed, nullptr);
  current_exchange = nullptr;
  if (!sent || !connection.AtMessageEnd()) exchange.close = true;
  if (options.metrics) {
    options.metrics->End({exchange.head.method, exchange.pattern,
                          exchange.status,
                          CalcMilliseconds(exchange.begin) * 1e-3});
  }
  std::vector<std::pair<std::string_view, std::string>> fields{
      {"id", exchange.id},
      {"method", exchange.head.method},
      {"target", exchange.head.target},
      {"status", fmt::to_string(exchange.status)},
      {"in", fmt::to_string(exchange.bytes_in)},
      {"out", fmt::to_string(exchange.bytes_out)},
      {"ms", fmt::format("{:.1f}", CalcMilliseconds(exchange.begin))}};
  if (!sent) fields.emplace_back("unsent", "true");
  Log(MakeLogLine("info", "request", fields));
}

void HttpServer::Impl::Answer(const httplib::ContentReader* reader,
                              httplib::Response& out) {
  Exchange& exchange = *current_exchange;
  HttpResponse response = Respond(exchange, reader);
  std::string timing;
  for (const auto& [stage, milliseconds] : response.timings) {
    timing += fmt::format("{};dur={:.1f}, ", stage, milliseconds);
  }
  timing += fmt::format("total;dur={:.1f}", CalcMilliseconds(exchange.begin));
  out.status = response.status;
  out.set_header("Server-Timing", timing);
  out.set_header("X-Request-Id", exchange.id);
  out.set_header("X-Content-Type-Options", "nosniff");
  for (const auto& [name, value] : response.headers) {
    out.set_header(name, value);
  }
  // Nothing that others uploaded is to act as a page of this server.
  if (!out.has_header("Content-Security-Policy")) {
    out.set_header("Content-Security-Policy",
                   "default-src 'none'; frame-ancestors 'none'; sandbox");
  }
  exchange.status = response.status;
  exchange.bytes_out = response.body.size();
  if (response.next_piece) {
    Stream(std::move(response), exchange, out);
  } else if (response.status != 204) {
    out.set_header("Content-Type", response.content_type);
    out.body = std::move(response.body);
  }
  // A kept connection makes room for those that wait for a thread.
  if (!exchange.connection->AtMessageEnd() || IsCrowded()) {
    exchange.close = true;
  }
}

HttpResponse HttpServer::Impl::Respond(Exchange& exchange,
                                       const httplib::ContentReader* reader) {
  if (exchange.unheard) {
    auto answer = Dispatcher::TurnAway(exchange.id);
    exchange.pattern = std::move(answer.pattern);
    return std::move(answer.response);
  }
  if (exchange.fault) {
    return MakeProblem(exchange.fault->fault, exchange.fault->detail, "",
                       exchange.id);
  }
  auto answer = dispatcher.Dispatch(
      {exchange.head, exchange.id,
       [&](const BodyTaker& take) { return ReadAll(exchange, reader, take); },
       IsLoopback(host), current_welcome == Welcome::kTurnedAway,
       stop.get_token()});
  exchange.pattern = std::move(answer.pattern);
  return std::move(answer.response);
}

void HttpServer::Impl::Stream(HttpResponse response, Exchange& exchange,
                              httplib::Response& out) {
  const auto send = [this, next = std::move(response.next_piece), &exchange](
                        size_t, httplib::DataSink& sink) {
    std::optional<std::string> piece;
    try {
      piece = next();
    } catch (const std::exception& exception) {
      // The client sees that the answer is cut short.
      dispatcher.LogInternal(exchange.id, exception.what());
      return false;
    } catch (...) {
      dispatcher.LogInternal(exchange.id, kUnknownException);
      return false;
    }
    if (!piece) {
      sink.done();
      return true;
    }
    exchange.bytes_out += piece->size();
    return sink.write(piece->data(), piece->size());
  };
  // HTTP/1.0 has no chunks: there the connection's end is the body's.
  if (exchange.head.http_1_0) {
    out.set_content_provider(response.content_type, send);
  } else {
    out.set_chunked_content_provider(response.content_type, send);
  }
}

HttpServer::HttpServer(Router router, HttpServerOptions options)
    : impl_(std::make_unique<Impl>(std::move(router), std::move(options))) {
  Impl& server = *impl_;
  Impl* const impl = impl_.get();
  server.set_tcp_nodelay(true);
  // Not the library's default, which lets two servers share a port.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  server.new_task_queue = [impl] {
    const size_t threads = impl->options.threads;
    auto* queue = new ConnectionQueue(
        threads, threads * impl->options.limits.max_waiting_per_thread);
    impl->queue = queue;
    return queue;
  };
  server.Get("/", [impl](const httplib::Request&, httplib::Response& out) {
    impl->Answer(nullptr, out);
  });
  server.Post("/", [impl](const httplib::Request&, httplib::Response& out,
                          const httplib::ContentReader& reader) {
    impl->Answer(&reader, out);
  });
  server.set_post_routing_handler(
      [](const httplib::Request&, httplib::Response& out) {
        out.headers.erase("Keep-Alive");
        out.headers.erase("Accept-Ranges");
        if (current_exchange->close) out.set_header("Connection", "close");
      });
}

HttpServer::~HttpServer() = default;

Result<int> HttpServer::Bind(const std::string& host, int port) {
  return impl_->Bind(host, port);
}

Result<void> HttpServer::Serve() {
  Impl& server = *impl_;
  while (!server.stop.stop_requested()) {
    server.bound_unserved = false;
    server.listen_after_bind();
    if (server.stop.stop_requested()) break;
    // The library gives up when accept() fails once, say for want of memory.
    server.Log(MakeLogLine("error", "listen_again"));
    GRASPDB_TRY_VOID(server.Bind(server.host, server.port));
  }
  return {};
}

void HttpServer::Stop() { impl_->RequestStop(); }

void HttpServer::CutConnections() { impl_->CutConnections(); }

}  // namespace graspdb
