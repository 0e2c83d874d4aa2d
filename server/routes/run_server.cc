#include <signal.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "server/config.h"
#include "server/http/http_server.h"
#include "server/routes/routes.h"

namespace graspdb {
namespace {

/** Written to by the signal handler, which may do little else. */
int stop_event = -1;

extern "C" void HandleStopSignal(int) { eventfd_write(stop_event, 1); }

/** Stops the server at the first SIGTERM or SIGINT; a second one kills. */
class StopOnSignal {
 public:
  explicit StopOnSignal(HttpServer& server) {
    stop_event = eventfd(0, EFD_CLOEXEC);
    waiter_ = std::thread([&server] {
      eventfd_t count = 0;
      while (eventfd_read(stop_event, &count) != 0) {
      }
      server.Stop();
    });
    struct sigaction action {};
    action.sa_handler = HandleStopSignal;
    action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
    sigaction(SIGTERM, &action, nullptr);
    sigaction(SIGINT, &action, nullptr);
  }
  ~StopOnSignal() {
    signal(SIGTERM, SIG_DFL);
    signal(SIGINT, SIG_DFL);
    eventfd_write(stop_event, 1);
    waiter_.join();
    close(stop_event);
  }
  StopOnSignal(const StopOnSignal&) = delete;

 private:
  std::thread waiter_;
};

void LogLine(const std::string& line) {
  const std::string whole = line + "\n";
  std::fwrite(whole.data(), 1, whole.size(), stderr);
}

/** Written under another name first: a reader sees the whole number. */
bool WritePortFile(const std::string& path, int port) {
  const std::string fresh = path + ".new";
  std::ofstream file(fresh);
  file << port << "\n";
  file.close();
  return file.good() && std::rename(fresh.c_str(), path.c_str()) == 0;
}

int Fail(const Error& error) {
  LogLine("graspdb: " + error.message + " " + error.hint);
  return 2;
}

}  // namespace

Result<void> CheckAddress(const ServerConfig& config) {
  HttpServer probe(Router{}, HttpServerOptions{});
  const auto port = probe.Bind(config.host, config.port);
  if (!port) return port.error();
  return {};
}

int RunServer(Service& service, const ServerConfig& config) {
  HttpServerOptions options;
  options.limits.max_upload_bytes = config.max_upload_bytes;
  options.threads = config.http_threads;
  options.log = LogLine;
  options.metrics = std::make_shared<RequestMetrics>();
  RouteOptions routes;
  routes.metrics = options.metrics;
  routes.default_wait = config.default_wait;
  const auto threads = static_cast<int>(config.http_threads);
  routes.held_threads =
      std::make_shared<WorkSlots>(std::max(1, threads / 2), 0);
  const auto cores = static_cast<int>(std::thread::hardware_concurrency());
  routes.work_slots =
      std::make_shared<WorkSlots>(std::max(1, cores), threads / 4);
  HttpServer server(MakeRouter(service, routes), std::move(options));
  const auto port = server.Bind(config.host, config.port);
  if (!port) return Fail(port.error());
  if (!config.port_file.empty() && !WritePortFile(config.port_file, *port)) {
    return Fail({ErrorCode::kStorage,
                 fmt::format("Cannot write {}.", config.port_file),
                 "Choose another --port-file."});
  }
  if (const auto started = service.StartWorkers(); !started) {
    return Fail(started.error());
  }
  Result<void> served;
  {
    const StopOnSignal stop(server);
    const bool bare_ipv6 = config.host.find(':') != std::string::npos;
    fmt::print("graspdb listening on http://{}:{}\n",
               bare_ipv6 ? "[" + config.host + "]" : config.host, *port);
    std::fflush(stdout);
    served = server.Serve();
  }
  service.StopWorkers();
  return served ? 0 : Fail(served.error());
}

}  // namespace graspdb
