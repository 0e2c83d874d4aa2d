#include <algorithm>

#include "server/codec/order_json.h"
#include "server/codec/record_json.h"
#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

constexpr int kMostListed = 1000;

/** The grasps that the filter describes, with what is known of them now. */
Result<HttpResponse> ListJudged(const Service& service,
                                const VerifyOrder& order) {
  GraspSearch search;
  search.query = order.query;
  search.query.sort = GraspQuery::Sort::kMerit;
  search.query.page.limit = std::min(order.limit, kMostListed);
  GRASPDB_TRY(page, service.QueryGrasps(search));
  return MakeListResponse(
      page, [&](const StoredGrasp& grasp) -> Result<std::string> {
        GRASPDB_TRY(hand, service.FindHandModel(grasp.hand));
        return ToJson(grasp, *hand);
      });
}

Result<HttpResponse> PostVerification(Service& service,
                                      const RouteOptions& options,
                                      const HttpRequest& request) {
  QueryReader query(request.query);
  const auto deadline = ReadDeadline(query);
  GRASPDB_TRY_VOID(query.Finish());
  GRASPDB_TRY(order, VerifyOrderFromJson(BodyOrEmptyObject(request)));
  GRASPDB_TRY_VOID(CheckPartLabels(service.store(), order.query.category,
                                   order.query.part_labels));
  GRASPDB_TRY(idempotency, Idempotency::Read(request, service));
  GRASPDB_TRY(job, service.SubmitVerify(order, {idempotency.key(), deadline}));
  return AnswerJob(
      service, *options.held_threads, request, options.default_wait, job,
      idempotency,
      [&](const StoredJob&) { return ListJudged(service, order); });
}

}  // namespace

void AddVerificationRoutes(Router& router, Service& service,
                           const RouteOptions& options) {
  router.Add({"POST", "/v1/verifications", BodyKind::kJson,
              [&service, options](const HttpRequest& request) {
                return PostVerification(service, options, request);
              }});
}

}  // namespace graspdb
