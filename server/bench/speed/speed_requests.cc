#include "server/bench/speed/speed_requests.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "server/bench/speed/http_client.h"
#include "server/bench/speed/server_process.h"
#include "server/bench/statistics.h"

namespace graspdb {
namespace {

// The same mesh as bytes that no server has seen.
std::string MakeFresh(const std::string& obj, int number) {
  return fmt::format("# {} of {}\n", number, Now()) + obj;
}

class RequestBench {
 public:
  RequestBench(const RequestOrder& order, ExecutionContext& context)
      : order_(order), context_(context) {}

  Result<Json> Run() {
    Json report;
    rows_ = Json::array();
    GRASPDB_TRY_VOID(MeasureCold());
    GRASPDB_TRY(server, ServerProcess::Start(order_.db, order_.server_options));
    GRASPDB_TRY_VOID(MeasureWarm(*server));
    Json queries = Json::array();
    for (const int connections : {1, 16}) {
      context_.ReportProgress("queries", 0.9);
      GRASPDB_TRY(load, MeasureQueries(server->port(), order_.category,
                                       connections, order_.query_seconds));
      queries.push_back({{"connections", connections},
                         {"p50", load.p50},
                         {"p99", load.p99},
                         {"per_second", load.per_second}});
    }
    report["rows"] = std::move(rows_);
    report["queries"] = std::move(queries);
    report["start_seconds"] = server->start_seconds();
    report["peak_bytes"] = server->CalcPeakMemory();
    return report;
  }

 private:
  Result<double> Post(BenchClient& client, const std::string& target,
                      const std::string& obj) {
    if (context_.Cancelled()) {
      return Error{ErrorCode::kCancelled, "The bench was cancelled."};
    }
    const std::string bytes = MakeFresh(obj, ++number_);
    const double start = Now();
    GRASPDB_TRY_VOID(client.Post(target, bytes));
    return Now() - start;
  }

  // Of so many sources of each part; a few sure grasps are enough, or all are
  // wanted.
  std::string GraspTarget(std::optional<int> count) const {
    return fmt::format("/v1/grasps?category={}&format=obj&sources={}{}",
                       order_.category, order_.sources,
                       count ? fmt::format("&count={}", *count) : "");
  }

  // Each the first request of a server.
  Result<void> MeasureCold() {
    Timing timing;
    for (int i = 0; i < order_.repetitions; ++i) {
      context_.ReportProgress("a cold server", 0.2 * i / order_.repetitions);
      GRASPDB_TRY(server,
                  ServerProcess::Start(order_.db, order_.server_options));
      BenchClient client(server->port());
      GRASPDB_TRY(seconds, Post(client, GraspTarget(1), Middle()));
      timing.samples.push_back(seconds);
    }
    AddGrasps("count=1, cold", Middle(), timing, 1.0);
    return {};
  }

  void AddGrasps(const std::string& what, const std::string& mesh,
                 const Timing& timing, std::optional<double> goal) {
    rows_.push_back(EncodeSpeedRow({"POST /v1/grasps, " + what,
                                    static_cast<int>(CountFaces(mesh)),
                                    timing,
                                    {},
                                    goal}));
  }

  const std::string& Middle() const {
    return order_.meshes[order_.meshes.size() / 2];
  }

  Result<void> MeasureWarm(const ServerProcess& server) {
    BenchClient client(server.port());
    for (const std::string& mesh : order_.meshes) {
      Timing timing;
      const int triangles = static_cast<int>(CountFaces(mesh));
      for (int i = 0; i < order_.repetitions; ++i) {
        context_.ReportProgress("uploads", 0.3);
        GRASPDB_TRY(seconds,
                    Post(client,
                         fmt::format("/v1/objects?category={}&format=obj",
                                     order_.category),
                         mesh));
        timing.samples.push_back(seconds);
      }
      rows_.push_back(
          EncodeSpeedRow({"POST /v1/objects", triangles, timing, {}, {}}));
    }
    for (const int count : {1, 5}) {
      Timing timing;
      for (int i = 0; i < order_.repetitions; ++i) {
        context_.ReportProgress("grasps", 0.5);
        GRASPDB_TRY(seconds, Post(client, GraspTarget(count), Middle()));
        timing.samples.push_back(seconds);
      }
      AddGrasps(fmt::format("count={}", count), Middle(), timing,
                count == 1 ? std::optional(1.0) : std::nullopt);
    }
    context_.ReportProgress("all grasps", 0.6);
    GRASPDB_TRY(all, Post(client, GraspTarget({}), Middle()));
    AddGrasps(fmt::format("all of {} sources", order_.sources), Middle(),
              MakeTiming(all), 2.0);
    if (order_.largest.empty()) return {};
    context_.ReportProgress("the largest mesh", 0.8);
    GRASPDB_TRY(largest, Post(client, GraspTarget(1), order_.largest));
    AddGrasps("count=1", order_.largest, MakeTiming(largest), 15.0);
    return {};
  }

  static int64_t CountFaces(const std::string& obj) {
    int64_t faces = 0;
    for (size_t at = 0; (at = obj.find("\nf ", at)) != std::string::npos;
         ++at) {
      ++faces;
    }
    return faces;
  }

  const RequestOrder& order_;
  ExecutionContext& context_;
  Json rows_;
  int number_{0};
};

}  // namespace

Result<QueryLoad> MeasureQueries(int port, const std::string& category,
                                 int connections, double seconds) {
  const std::string target =
      fmt::format("/v1/grasps?category={}&limit=20", category);
  std::mutex mutex;
  std::vector<double> latencies;
  std::optional<Error> error;
  const double start = Now();
  const double end = start + seconds;
  std::vector<std::thread> clients;
  for (int i = 0; i < connections; ++i) {
    clients.emplace_back([&] {
      BenchClient client(port);
      std::vector<double> own;
      std::optional<Error> failure;
      while (Now() < end && !failure) {
        const double begin = Now();
        if (const auto answer = client.Get(target); !answer) {
          failure = answer.error();
        }
        own.push_back(Now() - begin);
      }
      const std::lock_guard lock(mutex);
      latencies.insert(latencies.end(), own.begin(), own.end());
      if (failure) error = failure;
    });
  }
  for (std::thread& client : clients) client.join();
  if (error) return *error;
  const double took = Now() - start;
  const auto count = static_cast<double>(latencies.size());
  return QueryLoad{CalcQuantile(latencies, 0.5),
                   CalcQuantile(std::move(latencies), 0.99), count / took};
}

Result<Json> MeasureRequests(const RequestOrder& order,
                             ExecutionContext& context) {
  return RequestBench(order, context).Run();
}

}  // namespace graspdb
