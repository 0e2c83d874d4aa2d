#include <string>

#include <fmt/format.h>

#include "engine/grasp_engine.h"
#include "server/codec/parameters_json.h"
#include "server/codec/record_json.h"
#include "server/routes/openapi_document.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

/** Ready when the database answers and requests are taken. */
Result<HttpResponse> GetReady(const Service& service,
                              const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  if (request.stop.stop_requested()) {
    return Error{ErrorCode::kDeadlineExceeded, "The server is shutting down.",
                 "Ask another server."};
  }
  GRASPDB_TRY(counts, service.store().Count());
  return MakeJsonResponse(
      200, fmt::format(R"({{"status":"ready","counts":{}}})", ToJson(counts)));
}

Result<HttpResponse> GetHealth(const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  return MakeJsonResponse(
      200, fmt::format(R"({{"status":"ok","version":"{}"}})", EngineVersion()));
}

Result<HttpResponse> GetOpenApi(const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  return MakeJsonResponse(200, std::string(kOpenApiDocument));
}

Result<HttpResponse> GetParameters(const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  return MakeJsonResponse(200, DescribeParameters());
}

}  // namespace

void AddSystemRoutes(Router& router, Service& service) {
  router.Add(
      {"GET", "/healthz", BodyKind::kNone, GetHealth, /* vital = */ true});
  router.Add({"GET", "/readyz", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return GetReady(service, request);
              }});
  router.Add({"GET", "/openapi.json", BodyKind::kNone, GetOpenApi});
  router.Add({"GET", "/v1/parameters", BodyKind::kNone, GetParameters});
}

Router MakeRouter(Service& service, const RouteOptions& options) {
  Router router;
  AddSystemRoutes(router, service);
  AddCategoryRoutes(router, service, options);
  AddObjectRoutes(router, service, options);
  AddPartRoutes(router, service);
  AddGraspSpaceRoutes(router, service);
  AddGraspRoutes(router, service, options);
  AddTransferRoutes(router, service);
  AddVerificationRoutes(router, service, options);
  AddHandRoutes(router, service, options);
  AddJobRoutes(router, service, options);
  AddBackupRoutes(router, service);
  AddMetricsRoutes(router, service, options);
  AddViewerRoutes(router);
  return router;
}

}  // namespace graspdb
