#include <map>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "engine/render/grasp_scene.h"
#include "engine/render/png_encoder.h"
#include "engine/render/scene_renderer.h"
#include "server/codec/grasp_formats.h"
#include "server/codec/graspit_world.h"
#include "server/codec/parameters_json.h"
#include "server/codec/record_json.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

/** How the grasps of an answer are written. */
enum class GraspFormat { kJson, kCsv, kRos, kGraspit };

GraspFormat ReadFormat(QueryReader& query) {
  const auto as = query.Choice("as", {"json", "csv", "ros", "graspit"});
  if (as == "csv") return GraspFormat::kCsv;
  if (as == "ros") return GraspFormat::kRos;
  if (as == "graspit") return GraspFormat::kGraspit;
  return GraspFormat::kJson;
}

/** One world has one hand. */
Result<std::string> MakeGraspitWorld(const Service& service,
                                     const std::vector<GraspOfHand>& grasps) {
  std::vector<const StoredGrasp*> list;
  for (const GraspOfHand& pair : grasps) {
    if (pair.grasp->hand != grasps.front().grasp->hand) {
      return Error{ErrorCode::kInvalidArgument,
                   "A world of GraspIt! holds the grasps of one hand.",
                   "name the hand too", "hand"};
    }
    list.push_back(pair.grasp);
  }
  if (list.empty()) return std::string("<?xml version=\"1.0\" ?>\n<world/>\n");
  const HandModel& hand = *grasps.front().hand;
  GRASPDB_TRY(stored, service.store().FindHand(hand.name()));
  GRASPDB_TRY(file, HandFileFromJson(stored.annotations));
  if (!file.graspit) {
    return Error{ErrorCode::kInvalidArgument,
                 "The hand '" + hand.name() + "' is none of GraspIt!'s robots.",
                 "as takes json, csv, ros", "as"};
  }
  return GraspsToGraspit(list, hand, *file.graspit);
}

Result<HttpResponse> MakeGraspsResponse(const Service& service,
                                        const std::vector<GraspOfHand>& grasps,
                                        GraspFormat format) {
  if (format == GraspFormat::kRos) {
    return MakeJsonResponse(200, GraspsToRos(grasps));
  }
  HttpResponse response;
  if (format == GraspFormat::kGraspit) {
    GRASPDB_TRY(world, MakeGraspitWorld(service, grasps));
    response.content_type = "application/xml";
    response.body = std::move(world);
    return response;
  }
  response.content_type = "text/csv; charset=utf-8";
  response.body = GraspsToCsv(grasps);
  return response;
}

/** The grasps, each with its hand. */
Result<std::vector<GraspOfHand>> PairWithHands(
    const Service& service, const std::vector<StoredGrasp>& grasps) {
  std::vector<GraspOfHand> pairs;
  std::map<std::string, std::shared_ptr<const HandModel>> hands;
  for (const StoredGrasp& grasp : grasps) {
    auto& hand = hands[grasp.hand];
    if (!hand) {
      GRASPDB_TRY(found, service.FindHandModel(grasp.hand));
      hand = std::move(found);
    }
    pairs.push_back({&grasp, hand});
  }
  return pairs;
}

Result<GraspSearch> ReadSearch(QueryReader& query) {
  GraspSearch search;
  GraspQuery& wanted = search.query;
  search.task = query.Text("task").value_or("");
  wanted.category = query.Text("category").value_or("");
  wanted.part_labels = ReadList(query, "part");
  wanted.hand = query.Text("hand").value_or("");
  wanted.object_id = query.Text("object").value_or("");
  wanted.grasp_space_id = query.Text("grasp_space").value_or("");
  wanted.transfer_id = query.Text("transfer").value_or("");
  wanted.min_epsilon = query.Number("min_epsilon", 0.0, 1.0);
  wanted.held = query.Choice("verified", {"physical"}).has_value();
  if (const auto stage =
          query.Choice("stage", {"learned", "transfer", "assembly"})) {
    GRASPDB_TRY(parsed, ParseGraspStage(*stage));
    wanted.stage = parsed;
  }
  using Sort = GraspQuery::Sort;
  const auto sort =
      query.Choice("sort", {"epsilon", "merit", "hybrid", "robust", "newest"});
  wanted.sort = sort == "hybrid"   ? Sort::kHybrid
                : sort == "robust" ? Sort::kRobust
                : sort == "merit"  ? Sort::kMerit
                : sort == "newest" ? Sort::kNewest
                                   : Sort::kEpsilon;
  wanted.page = ReadPage(query);
  return search;
}

/** Whether the parts and tasks that the search names exist: of them only
 categories know. */
Result<void> CheckNames(const Store& store, const GraspSearch& search) {
  const GraspQuery& wanted = search.query;
  GRASPDB_TRY_VOID(CheckPartLabels(store, wanted.category, wanted.part_labels));
  if (wanted.category.empty() || search.task.empty()) return {};
  GRASPDB_TRY(category, store.FindCategory(wanted.category));
  std::set<std::string> tasks;
  for (const CategoryPart& part : category.parts) {
    for (const auto& [task, note] : part.tasks) tasks.insert(task);
  }
  if (!tasks.contains(search.task)) {
    return Error{ErrorCode::kNotFound,
                 fmt::format("The category {} has no task {}.", category.name,
                             search.task),
                 fmt::format("Known are {}.", fmt::join(tasks, ", ")), "task"};
  }
  return {};
}

Result<HttpResponse> ListAsJson(const Service& service, GraspTexts& texts,
                                const GraspSearch& search) {
  GRASPDB_TRY(page, service.QueryGraspKeys(search));
  std::vector<std::string> items;
  for (const GraspKey& key : page.items) {
    const auto text = texts.Get(key, service);
    if (text) {
      items.push_back(**text);
    } else if (text.error().code != ErrorCode::kNotFound) {  // Deleted since.
      return text.error();
    }
  }
  return MakeJsonResponse(200, ListToJson(items, page.next_cursor));
}

Result<HttpResponse> ListGrasps(const Service& service, GraspTexts& texts,
                                const HttpRequest& request) {
  QueryReader query(request.query);
  GRASPDB_TRY(search, ReadSearch(query));
  const GraspFormat format = ReadFormat(query);
  GRASPDB_TRY_VOID(query.Finish());
  GRASPDB_TRY_VOID(CheckNames(service.store(), search));
  if (format == GraspFormat::kJson) {
    return ListAsJson(service, texts, search);
  }
  GRASPDB_TRY(page, service.QueryGrasps(search));
  GRASPDB_TRY(pairs, PairWithHands(service, page.items));
  GRASPDB_TRY(response, MakeGraspsResponse(service, pairs, format));
  if (!page.next_cursor.empty()) {
    response.headers.emplace_back("X-Next-Cursor", page.next_cursor);
  }
  return response;
}

Result<HttpResponse> GetGrasp(const Service& service,
                              const HttpRequest& request) {
  QueryReader query(request.query);
  const GraspFormat format = ReadFormat(query);
  GRASPDB_TRY_VOID(query.Finish());
  GRASPDB_TRY(grasp,
              service.store().FindGrasp(request.path_parameters.at("id")));
  GRASPDB_TRY(hand, service.FindHandModel(grasp.hand));
  if (format == GraspFormat::kJson) {
    return MakeJsonResponse(200, ToJson(grasp, *hand));
  }
  return MakeGraspsResponse(service, {{&grasp, hand}}, format);
}

Result<HttpResponse> DrawGrasp(const Service& service, WorkSlots& slots,
                               const HttpRequest& request) {
  QueryReader query(request.query);
  View view;
  view.width =
      static_cast<int>(query.Integer("width", 64, 2048).value_or(view.width));
  view.height =
      static_cast<int>(query.Integer("height", 64, 2048).value_or(view.height));
  const auto azimuth = query.Number("azimuth", -6.3, 6.3);
  view.elevation =
      query.Number("elevation", -1.5, 1.5).value_or(view.elevation);
  GRASPDB_TRY_VOID(query.Finish());
  GRASPDB_TRY(stored,
              service.store().FindGrasp(request.path_parameters.at("id")));
  GRASPDB_TRY(hand, service.FindHandModel(stored.hand));
  GRASPDB_TRY(meshes, service.store().ReadObjectMeshes(stored.object_id));
  PosedHand posed{
      hand.get(), stored.grasp.configuration, stored.grasp.approach_O, {}};
  for (const Contact& contact : stored.grasp.contacts) {
    posed.contacts_O.push_back(contact.p_O);
  }
  if (azimuth) {
    view.azimuth = *azimuth;
  } else {
    view = TurnTowards(meshes.canonical, posed, view);
  }
  const auto scene =
      MakeGraspScene(meshes.canonical, meshes.canonical_labels, {posed});
  const auto slot = slots.Take(request.stop);
  if (!slot) return slot.error();
  const std::vector<uint8_t> png = EncodePng(RenderScene(scene, view));
  HttpResponse response;
  response.content_type = "image/png";
  response.body.assign(png.begin(), png.end());
  return response;
}

/** The parameters of POST /v1/grasps. */
Result<TransferOrder> ReadTransferOrder(const HttpRequest& request,
                                        QueryReader& query) {
  TransferOrder order;
  auto mesh = ReadUpload(request, query);
  order.object_id = query.Text("object").value_or("");
  order.category = query.Text("category").value_or("");
  order.part_labels = ReadList(query, "part");
  order.task = query.Text("task").value_or("");
  order.hand = query.Text("hand").value_or(kDefaultHand);
  if (const auto count = query.Integer("count", 1, 1000)) {
    order.count = static_cast<int>(*count);
  }
  order.exhaustive = query.Boolean("exhaustive").value_or(false);
  order.sources =
      static_cast<int>(query.Integer("sources", 1, 1000).value_or(40));
  order.stage = query.Choice("stage", {"transfer", "assembly"}) == "transfer"
                    ? GraspStage::kTransfer
                    : GraspStage::kAssembly;
  order.seed = ReadSeed(query);
  const auto parameters = query.Text("parameters", 4096);
  const auto friction = query.Number("friction", 0.01, 2.0);
  GRASPDB_TRY_VOID(query.Finish());
  if (!mesh) return mesh.error();
  if (parameters) {
    GRASPDB_TRY(given, ParametersFromJson(*parameters, order.parameters));
    order.parameters = given;
  }
  if (friction) order.parameters.contact.friction = *friction;
  if (mesh->has_value()) {
    order.mesh = std::move(**mesh);
    order.mesh.seed = order.seed;
    order.mesh.category = order.category;
  }
  return order;
}

/** One of a mesh and an object, one of parts and a task. */
Result<void> CheckTransferOrder(const TransferOrder& order, bool has_mesh) {
  if (has_mesh == !order.object_id.empty()) {
    return Error{ErrorCode::kInvalidArgument,
                 has_mesh ? "A mesh and a stored object are given at once."
                          : "There is neither a mesh nor a stored object.",
                 "Send the mesh as the body, or name a stored object with "
                 "object=ID.",
                 has_mesh ? "object" : "mesh"};
  }
  if (has_mesh && order.category.empty()) {
    return Error{ErrorCode::kInvalidArgument, "The category is missing.",
                 "category takes a category's name or auto.", "category"};
  }
  if (!order.part_labels.empty() && !order.task.empty()) {
    return Error{ErrorCode::kInvalidArgument,
                 "A part and a task are given at once.",
                 "Give part, or task, or neither for all parts.", "task"};
  }
  return {};
}

Result<HttpResponse> PostGrasps(Service& service, const RouteOptions& options,
                                HttpRequest& request) {
  QueryReader query(request.query);
  const GraspFormat format = ReadFormat(query);
  const auto deadline = ReadDeadline(query);
  GRASPDB_TRY(order, ReadTransferOrder(request, query));
  const bool has_mesh = !request.body.empty() || !request.files.empty();
  GRASPDB_TRY_VOID(CheckTransferOrder(order, has_mesh));
  GRASPDB_TRY(idempotency, Idempotency::Read(request, service));
  GRASPDB_TRY(job,
              service.SubmitTransfer(order, {idempotency.key(), deadline}));
  order.mesh = {};
  request.DropBody();
  return AnswerJob(
      service, *options.held_threads, request, options.default_wait, job,
      idempotency, [&](const StoredJob& done) -> Result<HttpResponse> {
        const auto answer =
            service.DescribeTransfer(done.result_id, order.count);
        if (!answer && answer.error().code == ErrorCode::kNotFound) {
          return Error{ErrorCode::kConflict,
                       "What this request led to has gone since: it was "
                       "deleted, or one of the same inputs found more.",
                       "send it again, under a new Idempotency-Key if any"};
        }
        if (!answer) return answer.error();
        HttpResponse response;
        if (format == GraspFormat::kJson) {
          response = MakeJsonResponse(200, ToJson(*answer));
        } else {
          GRASPDB_TRY(pairs, PairWithHands(service, answer->grasps));
          GRASPDB_TRY(written, MakeGraspsResponse(service, pairs, format));
          response = std::move(written);
        }
        for (const auto& [stage, seconds] : answer->transfer.seconds) {
          response.timings.emplace_back(stage, seconds * 1e3);
        }
        return response;
      });
}

}  // namespace

void AddGraspRoutes(Router& router, Service& service,
                    const RouteOptions& options) {
  router.Add(
      {"GET", "/v1/grasps", BodyKind::kNone,
       [&service, texts = options.grasp_texts](const HttpRequest& request) {
         return ListGrasps(service, *texts, request);
       }});
  router.Add({"POST", "/v1/grasps", BodyKind::kUpload,
              [&service, options](HttpRequest& request) {
                return PostGrasps(service, options, request);
              }});
  router.Add({"GET", "/v1/grasps/{id}", BodyKind::kNone,
              [&service](const HttpRequest& request) {
                return GetGrasp(service, request);
              }});
  router.Add(
      {"GET", "/v1/grasps/{id}.png", BodyKind::kNone,
       [&service, slots = options.picture_slots](const HttpRequest& request) {
         return DrawGrasp(service, *slots, request);
       }});
}

}  // namespace graspdb
