#pragma once

#include <string_view>

namespace graspdb {

/** schema/openapi.yaml as JSON, converted and embedded at build time. */
extern const std::string_view kOpenApiDocument;

}  // namespace graspdb
