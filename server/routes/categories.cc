#include "server/codec/input_json.h"
#include "server/codec/record_json.h"
#include "server/http/target.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

const std::string& Name(const HttpRequest& request) {
  return request.path_parameters.at("name");
}

Result<HttpResponse> ListCategories(const Service& service,
                                    const HttpRequest& request) {
  QueryReader query(request.query);
  const PageRequest page = ReadPage(query);
  GRASPDB_TRY_VOID(query.Finish());
  GRASPDB_TRY(found, service.store().ListCategories(page));
  return MakeListResponse(
      found, [](const StoredCategory& category) { return ToJson(category); });
}

Result<HttpResponse> PostCategory(Service& service,
                                  const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  return AnswerOnce(request, service, [&]() -> Result<HttpResponse> {
    GRASPDB_TRY(given, CategoryFromJson(request.body));
    GRASPDB_TRY(added, service.AddCategory(given));
    HttpResponse response =
        MakeJsonResponse(added.created ? 201 : 200, ToJson(added.category));
    response.headers.emplace_back(
        "Location", "/v1/categories/" + EncodePercent(added.category.name));
    return response;
  });
}

Result<HttpResponse> GetCategory(const Service& service,
                                 const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(category, service.store().FindCategory(Name(request)));
  return MakeJsonResponse(200, ToJson(category));
}

Result<HttpResponse> PatchOneCategory(Service& service,
                                      const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(stored, service.UpdateCategory(
                          Name(request), [&](const StoredCategory& category) {
                            return PatchCategory(category, request.body);
                          }));
  return MakeJsonResponse(200, ToJson(stored));
}

Result<HttpResponse> DeleteCategory(Service& service,
                                    const HttpRequest& request) {
  QueryReader query(request.query);
  const bool cascade = query.Boolean("cascade").value_or(false);
  GRASPDB_TRY_VOID(query.Finish());
  GRASPDB_TRY_VOID(service.store().DeleteCategory(Name(request), cascade));
  return MakeJsonResponse(204, "");
}

/** Imports a mesh as an example and, unless learn=false, learns from it. */
Result<HttpResponse> PostExample(Service& service, const RouteOptions& options,
                                 HttpRequest& request) {
  QueryReader query(request.query);
  auto upload = ReadUpload(request, query, {"labels"});
  const auto name = query.Text("name");
  const uint64_t seed = ReadSeed(query);
  const auto learn = query.Boolean("learn");
  const auto deadline = ReadDeadline(query);
  GRASPDB_TRY_VOID(query.Finish());
  if (!upload) return upload.error();
  if (!upload->has_value()) return MakeMissingMesh();
  ImportOrder order = std::move(**upload);
  order.role = ObjectRole::kExample;
  order.category = Name(request);
  order.name = name.value_or("");
  order.seed = seed;
  order.learn = learn.value_or(true);
  GRASPDB_TRY(face_labels, ReadLabels(request, *options.work_slots));
  order.face_labels = std::move(face_labels);
  GRASPDB_TRY(idempotency, Idempotency::Read(request, service));
  GRASPDB_TRY(job, service.SubmitImport(order, {idempotency.key(), deadline}));
  order = {};
  request.DropBody();
  return AnswerJob(service, *options.held_threads, request,
                   std::chrono::seconds(0), job, idempotency,
                   [&](const StoredJob& done) -> Result<HttpResponse> {
                     return DescribeObject(service, 200, done.result_id);
                   });
}

}  // namespace

void AddCategoryRoutes(Router& router, Service& service,
                       const RouteOptions& options) {
  const std::string one = "/v1/categories/{name}";
  router.Add({"GET", "/v1/categories", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return ListCategories(service, request);
              }});
  router.Add({"POST", "/v1/categories", BodyKind::kJson,
              [&service](const HttpRequest& request) {
                return PostCategory(service, request);
              }});
  router.Add(
      {"GET", one, BodyKind::kNone, [&service](const HttpRequest& request) {
         return GetCategory(service, request);
       }});
  router.Add(
      {"PATCH", one, BodyKind::kJson, [&service](const HttpRequest& request) {
         return PatchOneCategory(service, request);
       }});
  router.Add(
      {"DELETE", one, BodyKind::kNone, [&service](const HttpRequest& request) {
         return DeleteCategory(service, request);
       }});
  router.Add({"POST", one + "/examples", BodyKind::kUpload,
              [&service, options](HttpRequest& request) {
                return PostExample(service, options, request);
              }});
}

}  // namespace graspdb
