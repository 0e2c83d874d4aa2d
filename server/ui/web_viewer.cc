#include "server/ui/web_viewer.h"

namespace graspdb {
namespace {

constexpr char kPolicy[] =
    "default-src 'self'; script-src 'self'; style-src 'self'; "
    "img-src 'self' data: blob:; connect-src 'self'; worker-src 'self' blob:; "
    "object-src 'none'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

}  // namespace

std::optional<HttpResponse> FindViewerFile(std::string_view path) {
  for (const ViewerFile& file : WebViewerFiles()) {
    if (file.path != path) continue;
    HttpResponse response;
    response.content_type = file.content_type;
    response.headers = {
        {"Cache-Control",
         file.immutable ? "public, max-age=31536000, immutable" : "no-cache"},
        {"Content-Security-Policy", kPolicy},
        {"Referrer-Policy", "no-referrer"}};
    response.body = file.bytes;
    return response;
  }
  return std::nullopt;
}

}  // namespace graspdb
