#include "server/codec/record_json.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

Result<std::string> DescribeHand(const Service& service,
                                 const StoredHand& hand) {
  GRASPDB_TRY(model, service.FindHandModel(hand.name));
  return ToJson(hand, *model);
}

Result<HttpResponse> ListHands(const Service& service,
                               const HttpRequest& request) {
  QueryReader query(request.query);
  const PageRequest page = ReadPage(query);
  GRASPDB_TRY_VOID(query.Finish());
  GRASPDB_TRY(found, service.store().ListHands(page));
  return MakeListResponse(found, [&](const StoredHand& hand) {
    return DescribeHand(service, hand);
  });
}

Result<HttpResponse> GetHand(const Service& service,
                             const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(hand,
              service.store().FindHand(request.path_parameters.at("name")));
  GRASPDB_TRY(json, DescribeHand(service, hand));
  return MakeJsonResponse(200, json);
}

Result<HttpResponse> GetUrdf(const Service& service,
                             const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(hand,
              service.store().FindHand(request.path_parameters.at("name")));
  HttpResponse response;
  response.content_type = "application/xml";
  response.body = hand.urdf;
  return response;
}

}  // namespace

void AddHandRoutes(Router& router, Service& service) {
  router.Add({"GET", "/v1/hands", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return ListHands(service, request);
              }});
  router.Add({"POST", "/v1/hands", BodyKind::kUpload,
              [](const HttpRequest&) -> Result<HttpResponse> {
                return MakeNotBuilt("Uploading a hand");
              }});
  router.Add({"GET", "/v1/hands/{name}", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return GetHand(service, request);
              }});
  router.Add({"GET", "/v1/hands/{name}/urdf", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return GetUrdf(service, request);
              }});
}

}  // namespace graspdb
