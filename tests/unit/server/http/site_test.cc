#include "server/http/site.h"

#include <gtest/gtest.h>

namespace graspdb {
namespace {

MessageHead MakeHead(const std::string& method, const std::string& host) {
  MessageHead head;
  head.method = method;
  head.fields["host"] = host;
  return head;
}

bool IsForeign(const MessageHead& head, bool for_this_machine = true) {
  return FindForeignSite(head, for_this_machine).has_value();
}

TEST(FindForeignSite, OnThisMachineKnowsLocalhostAndAddressesOnly) {
  for (const char* host : {"localhost", "LOCALHOST:8080", "viewer.localhost",
                           "127.0.0.1:80", "[::1]:8080", "192.168.0.2", ""}) {
    EXPECT_FALSE(IsForeign(MakeHead("GET", host))) << host;
  }
  for (const char* host : {"evil.com", "localhost.evil.com:8080", "127.0.0.1.x",
                           "[evil]", "1.2.3.4.5"}) {
    EXPECT_TRUE(IsForeign(MakeHead("GET", host))) << host;
    EXPECT_FALSE(IsForeign(MakeHead("GET", host), false)) << host;
  }
}

TEST(FindForeignSite, RefusesChangesForAPageOfAnotherHost) {
  MessageHead head = MakeHead("POST", "localhost:8080");
  EXPECT_FALSE(IsForeign(head));
  head.fields["origin"] = "http://localhost:8080";
  EXPECT_FALSE(IsForeign(head));
  for (const char* origin : {"https://evil.com", "null", "localhost", "://"}) {
    head.fields["origin"] = origin;
    EXPECT_TRUE(IsForeign(head)) << origin;
    EXPECT_TRUE(IsForeign(head, false)) << origin;
  }
  head.method = "GET";
  EXPECT_FALSE(IsForeign(head));
}

TEST(FindForeignSite, BelievesAFrontWhichHostWasAsked) {
  MessageHead head = MakeHead("DELETE", "localhost");
  head.fields["origin"] = "https://grasps.lab:8443";
  EXPECT_TRUE(IsForeign(head));
  head.fields["x-forwarded-host"] = "grasps.lab";
  EXPECT_FALSE(IsForeign(head));
}

TEST(IsLoopback, KnowsThisMachine) {
  for (const char* host : {"127.0.0.1", "127.1.2.3", "::1", "localhost"}) {
    EXPECT_TRUE(IsLoopback(host)) << host;
  }
  for (const char* host : {"0.0.0.0", "::", "10.0.0.1", "lab"}) {
    EXPECT_FALSE(IsLoopback(host)) << host;
  }
}

}  // namespace
}  // namespace graspdb
