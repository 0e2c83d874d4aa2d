#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "engine/grasp_engine.h"
#include "server/decode/decode_client.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

// Of this process, from /proc, under the names that Prometheus' own clients
// use.
std::string WriteProcess() {
  std::ifstream statm("/proc/self/statm");
  int64_t virtual_pages = 0;
  int64_t resident_pages = 0;
  statm >> virtual_pages >> resident_pages;
  int64_t descriptors = 0;
  std::error_code error;
  for (std::filesystem::directory_iterator fd("/proc/self/fd", error), end;
       !error && fd != end; fd.increment(error)) {
    ++descriptors;
  }
  timespec cpu{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
  return WriteMetricHead("process_resident_memory_bytes", "gauge",
                         "Resident memory of the server.") +
         fmt::format("process_resident_memory_bytes {}\n",
                     resident_pages * sysconf(_SC_PAGESIZE)) +
         WriteMetricHead("process_open_fds", "gauge", "Open descriptors.") +
         fmt::format("process_open_fds {}\n", descriptors) +
         WriteMetricHead("process_cpu_seconds_total", "counter",
                         "Time on all cores.") +
         fmt::format("process_cpu_seconds_total {:.3f}\n",
                     static_cast<double>(cpu.tv_sec) +
                         1e-9 * static_cast<double>(cpu.tv_nsec));
}

std::string WriteDecoder(const DecodeCounts& counts) {
  std::string text =
      WriteMetricHead("graspdb_decoded_total", "counter",
                      "Mesh files by what became of them in the helper.");
  const auto add = [&text](const char* end, int64_t count) {
    text += fmt::format("graspdb_decoded_total{{end=\"{}\"}} {}\n", end, count);
  };
  add("admitted", counts.admitted);
  add("refused", counts.refused);
  add("crashed", counts.crashed);
  add("timed_out", counts.timed_out);
  add("unstarted", counts.unstarted);
  return text;
}

Result<std::string> WriteStore(const Store& store) {
  GRASPDB_TRY(jobs, store.CountJobs());
  GRASPDB_TRY(counts, store.Count());
  GRASPDB_TRY(bytes, store.CalcSize());
  std::string text = WriteMetricHead(
      "graspdb_jobs", "gauge", "Jobs in the database, by kind and state.");
  for (const JobKind kind : kJobKinds) {
    for (const JobState state :
         {JobState::kQueued, JobState::kRunning, JobState::kSucceeded,
          JobState::kFailed, JobState::kCancelled}) {
      text += fmt::format("graspdb_jobs{{kind=\"{}\",state=\"{}\"}} {}\n",
                          ToString(kind), ToString(state), jobs[{kind, state}]);
    }
  }
  text +=
      WriteMetricHead("graspdb_stored", "gauge", "What the database holds.");
  const auto add = [&text](const char* what, int64_t count) {
    text += fmt::format("graspdb_stored{{what=\"{}\"}} {}\n", what, count);
  };
  add("categories", counts.categories);
  add("objects", counts.objects);
  add("parts", counts.parts);
  add("hands", counts.hands);
  add("grasp_spaces", counts.grasp_spaces);
  add("grasps", counts.grasps);
  add("transfers", counts.transfers);
  text += WriteMetricHead("graspdb_database_bytes", "gauge",
                          "Size of the database file without its log.");
  text += fmt::format("graspdb_database_bytes {}\n", bytes);
  std::error_code none;
  const auto log = std::filesystem::file_size(store.path() + "-wal", none);
  text += WriteMetricHead("graspdb_database_log_bytes", "gauge",
                          "Size of the database's write-ahead log.");
  text += fmt::format("graspdb_database_log_bytes {}\n", none ? 0 : log);
  text += WriteMetricHead("graspdb_database_memory_bytes", "gauge",
                          "What the database keeps in memory.");
  text +=
      fmt::format("graspdb_database_memory_bytes {}\n", Store::CalcMemory());
  return text;
}

std::string WriteHeld(const WorkSlots& threads) {
  return WriteMetricHead("graspdb_http_held_threads", "gauge",
                         "Event streams and requests that wait for jobs.") +
         fmt::format("graspdb_http_held_threads {}\n", threads.taken());
}

std::string WriteCaches(const std::map<std::string, CacheCounts>& caches) {
  std::string lookups = WriteMetricHead("graspdb_cache_lookups_total",
                                        "counter", "Whether it was there.");
  std::string bytes = WriteMetricHead("graspdb_cache_bytes", "gauge",
                                      "What is remembered takes, about.");
  for (const auto& [name, counts] : caches) {
    for (const auto& [end, count] :
         {std::pair("hit", counts.hits), std::pair("miss", counts.misses)}) {
      lookups += fmt::format(
          "graspdb_cache_lookups_total{{cache=\"{}\",end=\"{}\"}} {}\n", name,
          end, count);
    }
    bytes += fmt::format("graspdb_cache_bytes{{cache=\"{}\"}} {}\n", name,
                         counts.bytes);
  }
  return lookups + bytes;
}

Result<HttpResponse> GetMetrics(const Service& service,
                                const RouteOptions& options,
                                const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(store, WriteStore(service.store()));
  auto caches = service.CountCaches();
  caches["grasp_texts"] = options.grasp_texts->counts();
  HttpResponse response;
  response.content_type = "text/plain; version=0.0.4; charset=utf-8";
  response.body =
      WriteMetricHead("graspdb_build_info", "gauge", "What runs here.") +
      fmt::format("graspdb_build_info{{version=\"{}\"}} 1\n", EngineVersion()) +
      (options.metrics ? options.metrics->Write() : "") +
      WriteHeld(*options.held_threads) +
      (options.jobs ? options.jobs->Write() : "") + store +
      WriteDecoder(service.CountDecoded()) + WriteCaches(caches) +
      WriteProcess();
  return response;
}

}  // namespace

void AddMetricsRoutes(Router& router, Service& service,
                      const RouteOptions& options) {
  router.Add({"GET", "/metrics", BodyKind::kNone,
              [&service, options](const HttpRequest& request) {
                return GetMetrics(service, options, request);
              }});
}

}  // namespace graspdb
