#include "server/codec/record_json.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {

void AddTransferRoutes(Router& router, Service& service) {
  router.Add({"GET", "/v1/transfers/{id}", BodyKind::kNone,
              [&service](const HttpRequest& request) -> Result<HttpResponse> {
                GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
                GRASPDB_TRY(transfer, service.store().FindTransfer(
                                          request.path_parameters.at("id")));
                return MakeJsonResponse(200, ToJson(transfer));
              }});
}

}  // namespace graspdb
