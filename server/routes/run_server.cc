#include <malloc.h>
#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "server/config.h"
#include "server/http/http_server.h"
#include "server/http/log_line.h"
#include "server/routes/routes.h"

namespace graspdb {
namespace {

void LogLine(const std::string& line) {
  const std::string whole = line + "\n";
  std::fwrite(whole.data(), 1, whole.size(), stderr);
}

/** Written to by the signal handler, which may do little else. */
int stop_event = -1;

extern "C" void HandleStopSignal(int) { eventfd_write(stop_event, 1); }

/** Stops the server at the first SIGTERM or SIGINT. What has not ended in time
 is cut off, at once when the other one comes, too; the same one again kills. */
class StopOnSignal {
 public:
  StopOnSignal(HttpServer& server, std::chrono::milliseconds drain_timeout) {
    stop_event = eventfd(0, EFD_CLOEXEC);
    waiter_ = std::thread([this, &server, drain_timeout] {
      WaitForStop(-1);
      server.Stop();
      if (!ended_) WaitForStop(static_cast<int>(drain_timeout.count()));
      if (ended_) return;
      LogLine(MakeLogLine("info", "drain_timeout"));
      server.CutConnections();
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
    ended_ = true;
    eventfd_write(stop_event, 1);
    waiter_.join();
    close(stop_event);
  }
  StopOnSignal(const StopOnSignal&) = delete;

 private:
  // For a signal, or the end of serving; -1: for ever.
  static void WaitForStop(int milliseconds) {
    pollfd file{stop_event, POLLIN, 0};
    while (true) {
      const int ready = poll(&file, 1, milliseconds);
      if (ready == 0) return;
      eventfd_t count = 0;
      if (ready > 0 && eventfd_read(stop_event, &count) == 0) return;
    }
  }

  std::atomic<bool> ended_{false};
  std::thread waiter_;
};

/** Written under another name first: a reader sees the whole number. */
bool WritePortFile(const std::string& path, int port) {
  const std::string fresh = path + ".new";
  std::ofstream file(fresh);
  file << port << "\n";
  file.close();
  return file.good() && std::rename(fresh.c_str(), path.c_str()) == 0;
}

JobObserver ObserveJobs(const std::shared_ptr<JobMetrics>& metrics) {
  JobObserver observer;
  observer.on_end = [metrics](const StoredJob& job, double seconds) {
    metrics->Add(job.kind, job.state, seconds);
    std::vector<std::pair<std::string_view, std::string>> fields{
        {"job", job.id},
        {"kind", ToString(job.kind)},
        {"state", ToString(job.state)},
        {"ms", fmt::format("{:.0f}", 1e3 * seconds)}};
    if (job.error) {
      fields.emplace_back("code", ToString(job.error->code));
      fields.emplace_back("cause", job.error->message);
    }
    LogLine(MakeLogLine("info", "job", fields));
  };
  observer.on_failure = [](const std::string& job, const std::string& what) {
    LogLine(MakeLogLine("error", "job", {{"job", job}, {"cause", what}}));
  };
  return observer;
}

/** Each connection is a file, and so are a job's pipes: the usual soft limit of
 1024 is for programs that call select(). */
void RaiseFileLimit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

/** A large block goes back to the system when it is freed. Else the allocator
 would take ever larger ones, the bodies of uploads, for what is worth keeping,
 and keep them in the arena of each thread. */
void ReturnLargeBlocks() {
  constexpr int kLarge = 4 << 20;
  mallopt(M_MMAP_THRESHOLD, kLarge);
  mallopt(M_TRIM_THRESHOLD, 2 * kLarge);
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
  const auto drain_timeout = options.limits.drain_timeout;
  options.log = LogLine;
  options.metrics = std::make_shared<RequestMetrics>();
  RouteOptions routes;
  routes.metrics = options.metrics;
  routes.jobs = std::make_shared<JobMetrics>();
  routes.default_wait = config.default_wait;
  // Half, three eighths and less than an eighth of the threads: from eight on
  // one at least is left for who asks for little.
  const auto threads = static_cast<int>(config.http_threads);
  routes.held_threads =
      std::make_shared<WorkSlots>(std::max(1, threads / 2), 0);
  const auto cores = static_cast<int>(std::thread::hardware_concurrency());
  routes.work_slots = std::make_shared<WorkSlots>(
      std::max(1, std::min(cores, threads / 8)), (threads - 1) / 4);
  routes.picture_slots =
      std::make_shared<WorkSlots>(1, std::max(0, threads / 8 - 2));
  RaiseFileLimit();
  ReturnLargeBlocks();
  HttpServer server(MakeRouter(service, routes), std::move(options));
  const auto port = server.Bind(config.host, config.port);
  if (!port) return Fail(port.error());
  // From here on, before anyone can know the port, a signal ends it in good
  // order.
  std::optional<StopOnSignal> stop(std::in_place, server, drain_timeout);
  if (!config.port_file.empty() && !WritePortFile(config.port_file, *port)) {
    return Fail({ErrorCode::kStorage,
                 fmt::format("Cannot write {}.", config.port_file),
                 "Choose another --port-file."});
  }
  if (const auto started = service.StartWorkers(ObserveJobs(routes.jobs));
      !started) {
    return Fail(started.error());
  }
  const bool bare_ipv6 = config.host.find(':') != std::string::npos;
  fmt::print("graspdb listening on http://{}:{}\n",
             bare_ipv6 ? "[" + config.host + "]" : config.host, *port);
  std::fflush(stdout);
  const Result<void> served = server.Serve();
  stop.reset();
  service.StopWorkers();
  return served ? 0 : Fail(served.error());
}

}  // namespace graspdb
