#include "server/ui/web_viewer.h"

#include <fmt/format.h>

#include "server/routes/routes.h"
#include "server/routes/support.h"

namespace graspdb {
namespace {

// The page itself takes any parameters: what it shows stands in its address.
Result<HttpResponse> GetViewer(const HttpRequest&) {
  auto page = FindViewerFile("/");
  GRASPDB_EXPECTS(page.has_value());
  return *std::move(page);
}

Result<HttpResponse> GetAsset(const HttpRequest& request) {
  GRASPDB_TRY_VOID(QueryReader(request.query).Finish());
  auto file = FindViewerFile("/assets/" + request.path_parameters.at("file"));
  if (file) return *std::move(file);
  return Error{
      ErrorCode::kNotFound,
      fmt::format("The viewer has no file {}.", request.path.substr(0, 200)),
      "Load the page at / again."};
}

}  // namespace

void AddViewerRoutes(Router& router) {
  router.Add({"GET", "/", BodyKind::kNone, GetViewer});
  router.Add({"GET", "/assets/{file}", BodyKind::kNone, GetAsset});
}

}  // namespace graspdb
