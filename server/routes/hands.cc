#include <algorithm>

#include <fmt/format.h>

#include "server/codec/mesh_writer.h"
#include "server/codec/record_json.h"
#include "server/files.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

constexpr char kFormHint[] =
    "curl -F hand=@hand.json -F urdf=@hand.urdf -F mesh=@palm.stl …";

Result<std::string> DescribeHand(const Service& service, const StoredHand& hand,
                                 const HttpRequest& request) {
  RequestContext context(request);
  GRASPDB_TRY(model, service.FindHandModel(hand.name, context.context()));
  return ToJson(hand, *model);
}

Result<HttpResponse> ListHands(const Service& service,
                               const HttpRequest& request) {
  QueryReader query(request.query);
  const PageRequest page = ReadPage(query);
  GRASPDB_TRY_VOID(query.Finish());
  GRASPDB_TRY(found, service.store().ListHands(page));
  return MakeListResponse(found, [&](const StoredHand& hand) {
    return DescribeHand(service, hand, request);
  });
}

Result<HttpResponse> GetHand(const Service& service,
                             const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(hand,
              service.store().FindHand(request.path_parameters.at("name")));
  GRASPDB_TRY(json, DescribeHand(service, hand, request));
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

/** A file that the URDF refers to, by its name without folders, in its own
 format where that is one we write. */
Result<HttpResponse> GetHandMesh(const Service& service,
                                 const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(hand,
              service.store().FindHand(request.path_parameters.at("name")));
  const std::string& file = request.path_parameters.at("file");
  const size_t dot = std::min(file.rfind('.'), file.size());
  const std::string extension = file.substr(std::min(dot + 1, file.size()));
  const bool stl = extension == "stl" || extension == "STL";
  for (const auto& [name, mesh] : hand.meshes) {
    if (CutFolders(name) != file) continue;
    HttpResponse response = MakeFileResponse(
        WriteMesh(mesh, stl ? MeshFormat::kStl : MeshFormat::kObj),
        file.substr(0, dot), stl ? "stl" : "obj");
    response.headers.emplace_back("Cache-Control", "private, max-age=3600");
    return response;
  }
  return Error{ErrorCode::kNotFound,
               fmt::format("The hand {} has no mesh {}.", hand.name, file),
               "GET /v1/hands/{name}/urdf names its meshes.", "file"};
}

/** The form's files hand (a hand.json), urdf, and mesh as often as it needs. */
Result<HandFiles> ReadHandFiles(const HttpRequest& request) {
  HandFiles files;
  bool described = false;
  bool drawn = false;
  for (const FormPart& file : request.files) {
    if (file.name == "hand" && !described) {
      files.annotations = file.content;
      described = true;
    } else if (file.name == "urdf" && !drawn) {
      files.urdf = file.content;
      drawn = true;
    } else if (file.name == "mesh") {
      files.meshes.emplace_back(file.filename, file.content);
    } else {
      return Error{
          ErrorCode::kInvalidArgument,
          fmt::format("The form has a file {} that a hand has not.", file.name),
          kFormHint, file.name};
    }
  }
  if (!described || !drawn) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("There is no file {} in the request.",
                             described ? "urdf" : "hand"),
                 kFormHint, described ? "urdf" : "hand"};
  }
  return files;
}

Result<HttpResponse> PostHand(Service& service, WorkSlots& slots,
                              const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  GRASPDB_TRY(files, ReadHandFiles(request));
  return AnswerOnce(request, service, [&]() -> Result<HttpResponse> {
    const auto slot = slots.Take(request.stop);
    if (!slot) return slot.error();
    RequestContext context(request);
    GRASPDB_TRY(added, service.AddHand(files, context.context()));
    GRASPDB_TRY(json, DescribeHand(service, added.hand, request));
    HttpResponse response = MakeJsonResponse(added.created ? 201 : 200, json);
    response.headers.emplace_back("Location", "/v1/hands/" + added.hand.name);
    return response;
  });
}

}  // namespace

void AddHandRoutes(Router& router, Service& service,
                   const RouteOptions& options) {
  router.Add({"GET", "/v1/hands", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return ListHands(service, request);
              }});
  router.Add(
      {"POST", "/v1/hands", BodyKind::kUpload,
       [&service, slots = options.work_slots](const HttpRequest& request) {
         return PostHand(service, *slots, request);
       }});
  router.Add({"GET", "/v1/hands/{name}", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return GetHand(service, request);
              }});
  router.Add({"GET", "/v1/hands/{name}/urdf", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return GetUrdf(service, request);
              }});
  router.Add({"GET", "/v1/hands/{name}/meshes/{file}", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return GetHandMesh(service, request);
              }});
}

}  // namespace graspdb
