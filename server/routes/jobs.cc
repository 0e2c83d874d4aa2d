#include <atomic>
#include <memory>

#include "server/codec/record_json.h"
#include "server/routes/job_events.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

Result<HttpResponse> ListJobs(const Service& service,
                              const HttpRequest& request) {
  QueryReader query(request.query);
  const auto word = query.Choice(
      "state", {"queued", "running", "succeeded", "failed", "cancelled"});
  const PageRequest page = ReadPage(query);
  GRASPDB_TRY_VOID(query.Finish());
  std::optional<JobState> state;
  if (word) {
    GRASPDB_TRY(parsed, ParseJobState(*word));
    state = parsed;
  }
  GRASPDB_TRY(found, service.ListJobs(state, page));
  return MakeListResponse(found,
                          [](const StoredJob& job) { return ToJson(job); });
}

Result<HttpResponse> GetJob(const Service& service,
                            const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(job, service.FindJob(request.path_parameters.at("id")));
  HttpResponse response = MakeJsonResponse(200, ToJson(job));
  if (!job.Finished()) response.headers.emplace_back("Retry-After", "1");
  return response;
}

/** Cancels; the job itself stays to be read. */
Result<HttpResponse> DeleteJob(Service& service, const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(job, service.CancelJob(request.path_parameters.at("id")));
  return MakeJsonResponse(200, ToJson(job));
}

/** Counts what is open, up to a limit. */
class Gate {
 public:
  explicit Gate(int limit) : left_(limit) {}
  /** A place, given back with its last copy; null when all are taken. */
  static std::shared_ptr<void> Enter(const std::shared_ptr<Gate>& gate) {
    if (gate->left_.fetch_sub(1) <= 0) {
      ++gate->left_;
      return nullptr;
    }
    return {gate.get(), [gate](void*) { ++gate->left_; }};
  }

 private:
  std::atomic<int> left_;
};

Result<HttpResponse> StreamJob(const Service& service,
                               const std::shared_ptr<Gate>& gate,
                               const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(job, service.FindJob(request.path_parameters.at("id")));
  auto place = Gate::Enter(gate);
  if (!place) {
    return Error{ErrorCode::kOverloaded,
                 "As many event streams are open as the server allows.",
                 "Ask GET /v1/jobs/{id} now and then instead."};
  }
  HttpResponse response;
  response.content_type = "text/event-stream";
  response.headers.emplace_back("Cache-Control", "no-store");
  response.next_piece = [place = std::move(place),
                         events = std::make_shared<JobEvents>(
                             service, std::move(job),
                             std::string(request.FindHeader("last-event-id")),
                             request.stop)] { return events->Next(); };
  return response;
}

}  // namespace

void AddJobRoutes(Router& router, Service& service,
                  const RouteOptions& options) {
  router.Add({"GET", "/v1/jobs", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return ListJobs(service, request);
              }});
  router.Add({"GET", "/v1/jobs/{id}", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return GetJob(service, request);
              }});
  router.Add(
      {"GET", "/v1/jobs/{id}/events", BodyKind::kNone,
       [&service, gate = std::make_shared<Gate>(options.max_event_streams)](
           const HttpRequest& request) {
         return StreamJob(service, gate, request);
       }});
  router.Add({"DELETE", "/v1/jobs/{id}", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return DeleteJob(service, request);
              }});
}

}  // namespace graspdb
