#include <algorithm>

#include <fmt/format.h>

#include "engine/admission/mesh_reader.h"
#include "server/codec/mesh_writer.h"
#include "server/codec/order_json.h"
#include "server/codec/record_json.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

const std::string& Id(const HttpRequest& request) {
  return request.path_parameters.at("id");
}

Result<HttpResponse> ListObjects(const Service& service,
                                 const HttpRequest& request) {
  QueryReader query(request.query);
  ObjectFilter filter;
  filter.category = query.Text("category").value_or("");
  const auto role = query.Choice("role", {"example", "novel"});
  const PageRequest page = ReadPage(query);
  GRASPDB_TRY_VOID(query.Finish());
  if (role) {
    filter.role = role == "example" ? ObjectRole::kExample : ObjectRole::kNovel;
  }
  if (!filter.category.empty()) {
    GRASPDB_TRY_VOID(service.store().FindCategory(filter.category));
  }
  GRASPDB_TRY(found, service.store().ListObjects(filter, page));
  return MakeListResponse(
      found, [](const StoredObject& object) { return ToJson(object); });
}

Result<HttpResponse> PostObject(Service& service, WorkSlots& slots,
                                const HttpRequest& request) {
  QueryReader query(request.query);
  auto upload = ReadUpload(request, query, {"labels"});
  const auto category = query.Text("category");
  const auto role = query.Choice("role", {"example", "novel"});
  const auto name = query.Text("name");
  const uint64_t seed = ReadSeed(query);
  GRASPDB_TRY_VOID(query.Finish());
  if (!upload) return upload.error();
  if (!upload->has_value()) return MakeMissingMesh();
  ImportOrder order = std::move(**upload);
  order.category = category.value_or("");
  order.role = role == "example" ? ObjectRole::kExample : ObjectRole::kNovel;
  order.name = name.value_or("");
  order.seed = seed;
  order.learn = false;
  GRASPDB_TRY(face_labels, ReadLabels(request, slots));
  order.face_labels = std::move(face_labels);
  return AnswerOnce(request, service, [&]() -> Result<HttpResponse> {
    RequestContext context(request);
    const auto slot = slots.Take(request.stop);
    if (!slot) return slot.error();
    GRASPDB_TRY(imported, service.ImportObject(order, context.context()));
    HttpResponse response = MakeJsonResponse(
        imported.created ? 201 : 200, ToJson(imported.object, imported.parts));
    response.headers.emplace_back("Location",
                                  "/v1/objects/" + imported.object.id);
    return response;
  });
}

Result<HttpResponse> SearchByShape(Service& service, WorkSlots& slots,
                                   const HttpRequest& request) {
  QueryReader query(request.query);
  auto upload = ReadUpload(request, query, {});
  ShapeQuery shape;
  shape.category = query.Text("category").value_or("");
  if (const auto role = query.Choice("role", {"example", "novel"})) {
    shape.role = *role == "example" ? ObjectRole::kExample : ObjectRole::kNovel;
  }
  shape.limit =
      static_cast<int>(query.Integer("limit", 1, 100).value_or(shape.limit));
  GRASPDB_TRY_VOID(query.Finish());
  if (!upload) return upload.error();
  if (!upload->has_value()) return MakeMissingMesh();
  if (!shape.category.empty()) {
    const auto category = service.store().FindCategory(shape.category);
    if (!category) return category.error();
  }
  return AnswerOnce(request, service, [&]() -> Result<HttpResponse> {
    RequestContext context(request);
    const auto slot = slots.Take(request.stop);
    if (!slot) return slot.error();
    GRASPDB_TRY(found,
                service.SearchByShape(**upload, shape, context.context()));
    std::vector<std::string> items;
    for (const SimilarObject& similar : found) items.push_back(ToJson(similar));
    return MakeJsonResponse(200, ListToJson(items, ""));
  });
}

Result<HttpResponse> GetObject(const Service& service,
                               const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  return DescribeObject(service, 200, Id(request));
}

Result<HttpResponse> DeleteObject(Service& service,
                                  const HttpRequest& request) {
  QueryReader query(request.query);
  const bool cascade = query.Boolean("cascade").value_or(false);
  GRASPDB_TRY_VOID(query.Finish());
  GRASPDB_TRY_VOID(service.store().DeleteObject(Id(request), cascade));
  return MakeJsonResponse(204, "");
}

/** The closed solid of one part, cut faces included. */
Result<TriangleMesh> FindPartMesh(const Store& store, const std::string& object,
                                  const std::string& part) {
  GRASPDB_TRY(parts, store.ListParts(object));
  std::string known;
  for (const StoredPart& one : parts) {
    if (one.label == part || one.id == part) {
      GRASPDB_TRY(solids, store.ReadSolids({one}));
      return std::move(solids.front().solid_O);
    }
    known += (known.empty() ? "" : ", ") + one.label;
  }
  return Error{ErrorCode::kNotFound,
               fmt::format("The object has no part {}.", part),
               known.empty() ? "The object has no parts: segment it first."
                             : fmt::format("Its parts are {}.", known),
               "part"};
}

Result<HttpResponse> GetMesh(const Service& service,
                             const HttpRequest& request) {
  QueryReader query(request.query);
  const std::string format =
      query.Choice("format", {"obj", "stl", "ply", "glb", "original"})
          .value_or("obj");
  const auto part = query.Text("part");
  GRASPDB_TRY_VOID(query.Finish());
  const Store& store = service.store();
  GRASPDB_TRY(object, store.FindObject(Id(request)));
  if (format == "original") {
    if (part) {
      return Error{ErrorCode::kInvalidArgument,
                   "The original file has no parts.",
                   "With part, format takes obj, stl, ply, glb.", "format"};
    }
    GRASPDB_TRY(bytes, store.ReadObjectBytes(object.id));
    return MakeFileResponse(std::move(bytes), object.id, object.format);
  }
  GRASPDB_TRY(mesh_format, ParseMeshFormat(format));
  if (part) {
    GRASPDB_TRY(mesh, FindPartMesh(store, object.id, *part));
    return MakeFileResponse(WriteMesh(mesh, mesh_format), object.id, format);
  }
  GRASPDB_TRY(meshes, store.ReadObjectMeshes(object.id));
  HttpResponse response = MakeFileResponse(
      WriteMesh(meshes.canonical, mesh_format), object.id, format);
  // The parts of an object change; its mesh does not.
  response.headers.emplace_back("Cache-Control",
                                "private, max-age=31536000, immutable");
  return response;
}

Result<HttpResponse> ListParts(const Service& service,
                               const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(object, service.store().FindObject(Id(request)));
  Page<StoredPart> page;
  GRASPDB_TRY(parts, service.store().ListParts(object.id));
  page.items = std::move(parts);
  return MakeListResponse(page,
                          [](const StoredPart& part) { return ToJson(part); });
}

Result<HttpResponse> PostSegmentation(Service& service,
                                      const RouteOptions& options,
                                      const HttpRequest& request) {
  QueryReader query(request.query);
  const bool cascade = query.Boolean("cascade").value_or(false);
  const auto deadline = ReadDeadline(query);
  GRASPDB_TRY_VOID(query.Finish());
  GRASPDB_TRY_VOID(service.store().FindObject(Id(request)));
  auto slot = TakeToParse(request.body.size(), *options.work_slots, request);
  if (!slot) return slot.error();
  GRASPDB_TRY(order, SegmentOrderFromJson(BodyOrEmptyObject(request)));
  slot->reset();
  order.object_id = Id(request);
  order.cascade = cascade;
  GRASPDB_TRY(idempotency, Idempotency::Read(request, service));
  GRASPDB_TRY(job, service.SubmitSegment(order, {idempotency.key(), deadline}));
  return AnswerJob(service, *options.held_threads, request,
                   options.default_wait, job, idempotency,
                   [&](const StoredJob& done) {
                     return DescribeObject(service, 200, done.result_id);
                   });
}

Result<HttpResponse> PostGraspSpaces(Service& service,
                                     const RouteOptions& options,
                                     const HttpRequest& request) {
  QueryReader query(request.query);
  const auto deadline = ReadDeadline(query);
  GRASPDB_TRY_VOID(query.Finish());
  GRASPDB_TRY(order, LearnOrderFromJson(BodyOrEmptyObject(request)));
  order.object_id = Id(request);
  GRASPDB_TRY(idempotency, Idempotency::Read(request, service));
  GRASPDB_TRY(job, service.SubmitLearn(order, {idempotency.key(), deadline}));
  return AnswerJob(
      service, *options.held_threads, request, std::chrono::seconds(0), job,
      idempotency, [&](const StoredJob& done) -> Result<HttpResponse> {
        GraspSpaceFilter filter;
        filter.object_id = done.result_id;
        PageRequest all;
        all.limit = 1000;
        GRASPDB_TRY(page, service.store().ListGraspSpaces(filter, all));
        return MakeListResponse(
            page, [](const StoredGraspSpace& space) { return ToJson(space); });
      });
}

}  // namespace

void AddObjectRoutes(Router& router, Service& service,
                     const RouteOptions& options) {
  const std::string one = "/v1/objects/{id}";
  router.Add(
      {"POST", "/v1/search", BodyKind::kUpload,
       [&service, slots = options.work_slots](const HttpRequest& request) {
         return SearchByShape(service, *slots, request);
       }});
  router.Add({"GET", "/v1/objects", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return ListObjects(service, request);
              }});
  router.Add(
      {"POST", "/v1/objects", BodyKind::kUpload,
       [&service, slots = options.work_slots](const HttpRequest& request) {
         return PostObject(service, *slots, request);
       }});
  router.Add(
      {"GET", one, BodyKind::kNone, [&service](const HttpRequest& request) {
         return GetObject(service, request);
       }});
  router.Add(
      {"DELETE", one, BodyKind::kNone, [&service](const HttpRequest& request) {
         return DeleteObject(service, request);
       }});
  router.Add({"GET", one + "/mesh", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return GetMesh(service, request);
              }});
  router.Add({"GET", one + "/parts", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return ListParts(service, request);
              }});
  router.Add({"POST", one + "/segmentation", BodyKind::kJson,
              [&service, options](const HttpRequest& request) {
                return PostSegmentation(service, options, request);
              }});
  router.Add({"POST", one + "/grasp-spaces", BodyKind::kJson,
              [&service, options](const HttpRequest& request) {
                return PostGraspSpaces(service, options, request);
              }});
}

}  // namespace graspdb
