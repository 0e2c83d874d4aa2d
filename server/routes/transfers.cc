#include "server/codec/record_json.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

Result<HttpResponse> ListTransfers(const Service& service,
                                   const HttpRequest& request) {
  QueryReader query(request.query);
  TransferFilter filter;
  filter.category = query.Text("category").value_or("");
  filter.object_id = query.Text("object").value_or("");
  const PageRequest page = ReadPage(query);
  GRASPDB_TRY_VOID(query.Finish());
  const Store& store = service.store();
  if (!filter.category.empty()) {
    GRASPDB_TRY_VOID(store.FindCategory(filter.category));
  }
  if (!filter.object_id.empty()) {
    GRASPDB_TRY_VOID(store.FindObject(filter.object_id));
  }
  GRASPDB_TRY(found, store.ListTransfers(filter, page));
  return MakeListResponse(found, [](const StoredTransfer& transfer) {
    return ToSummaryJson(transfer);
  });
}

Result<HttpResponse> GetTransfer(const Service& service,
                                 const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(transfer,
              service.store().FindTransfer(request.path_parameters.at("id")));
  return MakeJsonResponse(200, ToJson(transfer));
}

}  // namespace

void AddTransferRoutes(Router& router, Service& service) {
  router.Add({"GET", "/v1/transfers", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return ListTransfers(service, request);
              }});
  router.Add({"GET", "/v1/transfers/{id}", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return GetTransfer(service, request);
              }});
}

}  // namespace graspdb
