#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "server/http/message.h"

namespace graspdb {

/** One file of the web viewer. */
struct ViewerFile {
  std::string_view path;  ///< "/" for the page, else "/assets/…".
  std::string_view content_type;
  std::string_view bytes;
  bool immutable{false};  ///< Its name changes with its content.
};

/** The built web viewer, clients/web/dist, as it was when this was built. */
std::span<const ViewerFile> WebViewerFiles();

/** The answer with the viewer's file at this path, or nothing. The page may
 load its own files and the API, nothing from elsewhere and nothing inline. */
std::optional<HttpResponse> FindViewerFile(std::string_view path);

}  // namespace graspdb
