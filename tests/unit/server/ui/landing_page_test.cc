#include "server/ui/landing_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace graspdb {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(LandingPage, ListsEveryOperationAndOneCurlLine) {
  const std::string page =
      MakeLandingPage({{"GET", "/v1/hands"}, {"POST", "/v1/grasps"}});
  EXPECT_THAT(page, HasSubstr("curl --data-binary @mug.stl"));
  EXPECT_THAT(page, HasSubstr("<td>POST</td><td>/v1/grasps</td>"));
}

TEST(LandingPage, LinksWhatABrowserCanOpen) {
  const std::string page =
      MakeLandingPage({{"GET", "/v1/hands"}, {"GET", "/v1/hands/{name}"}});
  EXPECT_THAT(page, HasSubstr("<a href=\"/v1/hands\">"));
  EXPECT_THAT(page, Not(HasSubstr("href=\"/v1/hands/{name}\"")));
}

TEST(LandingPage, HasNoScript) {
  EXPECT_THAT(MakeLandingPage({}), Not(HasSubstr("<script")));
}

}  // namespace
}  // namespace graspdb
