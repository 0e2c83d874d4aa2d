#include "server/codec/record_json.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

Result<HttpResponse> ListBackups(Service& service, const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(backups, service.backups().List());
  return MakeListResponse(
      Page<StoredBackup>{std::move(backups), ""},
      [](const StoredBackup& backup) { return ToJson(backup); });
}

Result<HttpResponse> PostBackup(Service& service, const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  return AnswerOnce(request, service, [&]() -> Result<HttpResponse> {
    RequestContext context(request);
    GRASPDB_TRY(backup,
                service.backups().Add(service.store(), context.context()));
    return MakeJsonResponse(201, ToJson(backup));
  });
}

}  // namespace

void AddBackupRoutes(Router& router, Service& service) {
  router.Add({"GET", "/v1/backups", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return ListBackups(service, request);
              }});
  router.Add({"POST", "/v1/backups", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return PostBackup(service, request);
              }});
}

}  // namespace graspdb
