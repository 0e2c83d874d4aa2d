#include "server/codec/record_json.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

Result<HttpResponse> ListGraspSpaces(const Service& service,
                                     const HttpRequest& request) {
  QueryReader query(request.query);
  GraspSpaceFilter filter;
  filter.category = query.Text("category").value_or("");
  filter.part_label = query.Text("part").value_or("");
  filter.hand = query.Text("hand").value_or("");
  filter.object_id = query.Text("object").value_or("");
  const PageRequest page = ReadPage(query);
  GRASPDB_TRY_VOID(query.Finish());
  const Store& store = service.store();
  if (!filter.category.empty()) {
    GRASPDB_TRY_VOID(store.FindCategory(filter.category));
  }
  if (!filter.part_label.empty()) {
    GRASPDB_TRY_VOID(
        CheckPartLabels(store, filter.category, {filter.part_label}));
  }
  if (!filter.hand.empty()) GRASPDB_TRY_VOID(store.FindHand(filter.hand));
  if (!filter.object_id.empty()) {
    GRASPDB_TRY_VOID(store.FindObject(filter.object_id));
  }
  GRASPDB_TRY(found, store.ListGraspSpaces(filter, page));
  return MakeListResponse(
      found, [](const StoredGraspSpace& space) { return ToJson(space); });
}

Result<HttpResponse> GetGraspSpace(const Service& service,
                                   const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(space,
              service.store().FindGraspSpace(request.path_parameters.at("id")));
  return MakeJsonResponse(200, ToJson(space));
}

Result<HttpResponse> DeleteGraspSpace(Service& service,
                                      const HttpRequest& request) {
  QueryReader query(request.query);
  const bool cascade = query.Boolean("cascade").value_or(false);
  GRASPDB_TRY_VOID(query.Finish());
  GRASPDB_TRY_VOID(service.store().DeleteGraspSpace(
      request.path_parameters.at("id"), cascade));
  return MakeJsonResponse(204, "");
}

}  // namespace

void AddGraspSpaceRoutes(Router& router, Service& service) {
  router.Add({"GET", "/v1/grasp-spaces", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return ListGraspSpaces(service, request);
              }});
  router.Add({"GET", "/v1/grasp-spaces/{id}", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return GetGraspSpace(service, request);
              }});
  router.Add({"DELETE", "/v1/grasp-spaces/{id}", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return DeleteGraspSpace(service, request);
              }});
}

}  // namespace graspdb
