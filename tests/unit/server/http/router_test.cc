#include "server/http/router.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

Route MakeRoute(const std::string& method, const std::string& pattern) {
  return {method, pattern, BodyKind::kNone,
          [](const HttpRequest&) { return HttpResponse{}; }};
}

Router MakeRouter() {
  Router router;
  router.Add(MakeRoute("GET", "/"));
  router.Add(MakeRoute("GET", "/v1/grasps/{id}"));
  router.Add(MakeRoute("GET", "/v1/grasps/{id}.png"));
  router.Add(MakeRoute("GET", "/v1/grasps/best"));
  router.Add(MakeRoute("POST", "/v1/grasps"));
  router.Add(MakeRoute("GET", "/v1/grasps"));
  router.Add(MakeRoute("GET", "/v1/objects/{id}/{what}"));
  return router;
}

TEST(Router, FindsARouteByMethodAndPath) {
  const Router router = MakeRouter();
  const auto match = router.Find("POST", {"v1", "grasps"});
  ASSERT_NE(match.route, nullptr);
  EXPECT_EQ(match.route->method, "POST");
  EXPECT_EQ(match.route->pattern, "/v1/grasps");
}

TEST(Router, RootIsAPathWithoutSegments) {
  EXPECT_EQ(MakeRouter().Find("GET", {}).allowed.size(), 1);
}

TEST(Router, CapturesEveryParameter) {
  const Router router = MakeRouter();
  const auto match = router.Find("GET", {"v1", "objects", "7", "mesh"});
  EXPECT_THAT(match.path_parameters,
              ElementsAre(Pair("id", "7"), Pair("what", "mesh")));
}

TEST(Router, TheMatchWithMostLiteralTextWins) {
  const Router router = MakeRouter();
  const auto png = router.Find("GET", {"v1", "grasps", "7.png"});
  EXPECT_EQ(png.route->pattern, "/v1/grasps/{id}.png");
  EXPECT_THAT(png.path_parameters, ElementsAre(Pair("id", "7")));
  EXPECT_EQ(router.Find("GET", {"v1", "grasps", "best"}).route->pattern,
            "/v1/grasps/best");
  EXPECT_EQ(router.Find("GET", {"v1", "grasps", "7.jpg"}).route->pattern,
            "/v1/grasps/{id}");
}

TEST(Router, AParameterIsNeverEmpty) {
  const Router router = MakeRouter();
  EXPECT_EQ(router.Find("GET", {"v1", "grasps", ""}).route, nullptr);
  EXPECT_EQ(router.Find("GET", {"v1", "grasps", ".png"}).route->pattern,
            "/v1/grasps/{id}");
}

TEST(Router, AnUnknownPathAllowsNothing) {
  const auto match = MakeRouter().Find("GET", {"v2"});
  EXPECT_EQ(match.route, nullptr);
  EXPECT_THAT(match.allowed, IsEmpty());
}

TEST(Router, AKnownPathWithAnotherMethodTellsItsMethods) {
  const auto match = MakeRouter().Find("DELETE", {"v1", "grasps"});
  EXPECT_EQ(match.route, nullptr);
  EXPECT_THAT(match.allowed, ElementsAre("GET", "POST"));
}

TEST(Router, TheSameRouteTwiceIsABug) {
  Router router = MakeRouter();
  EXPECT_THROW(router.Add(MakeRoute("GET", "/")), ContractViolation);
}

}  // namespace
}  // namespace graspdb
