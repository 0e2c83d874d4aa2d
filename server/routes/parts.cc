#include "server/codec/input_json.h"
#include "server/codec/record_json.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

Result<HttpResponse> GetPart(const Service& service,
                             const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(part, service.store().FindPart(request.path_parameters.at("id")));
  return MakeJsonResponse(200, ToJson(part));
}

/** Gives the part another label; answers the object with its parts, whose ids
 follow from their content and so may be new. */
Result<HttpResponse> PatchPart(Service& service, const HttpRequest& request) {
  QueryReader query(request.query);
  const bool cascade = query.Boolean("cascade").value_or(false);
  GRASPDB_TRY_VOID(query.Finish());
  GRASPDB_TRY(label, PartLabelFromJson(request.body));
  GRASPDB_TRY(
      done, service.Relabel(request.path_parameters.at("id"), label, cascade));
  return MakeJsonResponse(200, ToJson(done.object, done.parts));
}

}  // namespace

void AddPartRoutes(Router& router, Service& service) {
  router.Add({"GET", "/v1/parts/{id}", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return GetPart(service, request);
              }});
  router.Add({"PATCH", "/v1/parts/{id}", BodyKind::kJson,
              [&service](const HttpRequest& request) {
                return PatchPart(service, request);
              }});
}

}  // namespace graspdb
