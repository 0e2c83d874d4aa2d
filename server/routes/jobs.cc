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

Result<HttpResponse> StreamJob(const Service& service, WorkSlots& slots,
                               const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(job, service.FindJob(request.path_parameters.at("id")));
  auto place = slots.Take(request.stop);
  if (!place) {
    return Error{ErrorCode::kOverloaded,
                 "As many clients wait for jobs as the server allows.",
                 "Ask GET /v1/jobs/{id} now and then instead."};
  }
  HttpResponse response;
  response.content_type = "text/event-stream";
  response.headers.emplace_back("Cache-Control", "no-store");
  response.next_piece = [place = *std::move(place),
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
       [&service, slots = options.held_threads](const HttpRequest& request) {
         return StreamJob(service, *slots, request);
       }});
  router.Add({"DELETE", "/v1/jobs/{id}", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return DeleteJob(service, request);
              }});
}

}  // namespace graspdb
