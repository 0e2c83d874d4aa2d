#include "server/routes/openapi_document.h"

#include <set>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "server/http/problem.h"
#include "server/records.h"

namespace graspdb {
namespace {

TEST(OpenApiDocument, IsOpenApi31) {
  const auto document = nlohmann::json::parse(kOpenApiDocument);
  EXPECT_EQ(document["openapi"], "3.1.0");
  EXPECT_FALSE(document["paths"].empty());
}

TEST(Problem, KindsHaveTheNamesThatTheDatabaseKeeps) {
  for (const ErrorCode code :
       {ErrorCode::kInvalidArgument, ErrorCode::kUnusableInput,
        ErrorCode::kTooLarge, ErrorCode::kNotFound, ErrorCode::kConflict,
        ErrorCode::kNotInCategory, ErrorCode::kCancelled,
        ErrorCode::kDeadlineExceeded, ErrorCode::kStorage,
        ErrorCode::kOverloaded, ErrorCode::kKeyReused,
        ErrorCode::kNotImplemented, ErrorCode::kInternal}) {
    EXPECT_STREQ(KindOf(code).code, ToString(code));
  }
}

}  // namespace
}  // namespace graspdb
