#include "server/http/problem.h"

#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace graspdb {
namespace {

using nlohmann::json;

TEST(Problem, FollowsRfc9457) {
  const HttpResponse response =
      MakeProblem({ErrorCode::kNotFound, "There is no hand x.",
                   "Known are barrett-bh8-280.", "hand"},
                  "r1");
  EXPECT_EQ(response.status, 404);
  EXPECT_EQ(response.content_type, "application/problem+json");
  const json body = json::parse(response.body);
  EXPECT_EQ(body["type"], "urn:graspdb:problem:not_found");
  EXPECT_EQ(body["title"], "There is no such thing");
  EXPECT_EQ(body["status"], 404);
  EXPECT_EQ(body["detail"], "There is no hand x.");
  EXPECT_EQ(body["hint"], "Known are barrett-bh8-280.");
  EXPECT_EQ(body["field"], "hand");
  EXPECT_EQ(body["code"], "not_found");
  EXPECT_EQ(body["request_id"], "r1");
}

TEST(Problem, LeavesOutHintAndFieldWhenThereAreNone) {
  const json body =
      json::parse(MakeProblem({ErrorCode::kConflict, "No."}, "r1").body);
  EXPECT_FALSE(body.contains("hint"));
  EXPECT_FALSE(body.contains("field"));
}

TEST(Problem, AnInternalErrorTellsNothing) {
  const HttpResponse response = MakeProblem(
      {ErrorCode::kInternal, "secret at /home/x.cc:12", "secret"}, "r1");
  EXPECT_EQ(response.status, 500);
  EXPECT_THAT(response.body, testing::Not(testing::HasSubstr("secret")));
  EXPECT_THAT(response.body, testing::HasSubstr("r1"));
}

TEST(Problem, ReplacesBytesThatAreNoUtf8) {
  const HttpResponse response =
      MakeProblem({ErrorCode::kUnusableInput, "bad \xff name"}, "r1");
  EXPECT_EQ(json::parse(response.body)["detail"], "bad \xEF\xBF\xBD name");
}

TEST(Problem, ARetryableOneSaysWhen) {
  const auto retry =
      std::make_pair(std::string("Retry-After"), std::string("1"));
  EXPECT_THAT(MakeProblem({ErrorCode::kStorage, ""}, "").headers,
              testing::Contains(retry));
  EXPECT_THAT(MakeProblem({ErrorCode::kNotFound, ""}, "").headers,
              testing::IsEmpty());
}

TEST(Problem, KindsAreThoseOfErrorsYaml) {
  std::ifstream file(GRASPDB_SOURCE_DIR "/schema/errors.yaml");
  std::stringstream text;
  text << file.rdbuf();
  const std::string yaml = text.str();
  const std::regex row(
      R"re(- \{code: (\w+), status: (\d+), retryable: (\w+),\s*)re"
      R"re(title: "?([^"\n]*?)"?,\n)re");
  std::vector<std::string> documented;
  for (std::sregex_iterator it(yaml.begin(), yaml.end(), row), end; it != end;
       ++it) {
    documented.push_back((*it)[1].str() + " " + (*it)[2].str() + " " +
                         (*it)[3].str() + " " + (*it)[4].str());
  }
  std::vector<std::string> known;
  for (const ProblemKind& kind : AllProblemKinds()) {
    known.push_back(std::string(kind.code) + " " + std::to_string(kind.status) +
                    " " + (kind.retryable ? "true" : "false") + " " +
                    kind.title);
  }
  EXPECT_EQ(documented, known);
}

TEST(Problem, EveryCodeIsItsOwnAndNoneIsMissing) {
  std::set<std::string> codes;
  for (const ProblemKind& kind : AllProblemKinds()) codes.insert(kind.code);
  EXPECT_EQ(codes.size(), AllProblemKinds().size());
  // The last values of both enums.
  const size_t count = static_cast<size_t>(ErrorCode::kInternal) + 1 +
                       static_cast<size_t>(HttpFault::kHeaderFieldsTooLarge) +
                       1;
  EXPECT_EQ(AllProblemKinds().size(), count);
}

}  // namespace
}  // namespace graspdb
