#include "server/http/log_line.h"

#include <gmock/gmock.h>

namespace graspdb {
namespace {

using testing::EndsWith;
using testing::MatchesRegex;

TEST(LogLine, HasTimeLevelEventAndFieldsInOrder) {
  EXPECT_THAT(
      MakeLogLine("info", "request", {{"id", "r-1"}, {"status", "200"}}),
      MatchesRegex("time=....-..-..T..:..:..\\....Z level=info event=request "
                   "id=r-1 status=200"));
}

TEST(LogLine, QuotesWhatIsNoWord) {
  EXPECT_THAT(MakeLogLine("error", "x", {{"cause", "no room"}}),
              EndsWith(" cause=\"no room\""));
  EXPECT_THAT(MakeLogLine("error", "x", {{"cause", ""}}),
              EndsWith(" cause=\"\""));
}

TEST(LogLine, CannotBeForged) {
  const std::string line =
      MakeLogLine("info", "x", {{"target", "/\" status=200\ntime=\xff\\"}});
  EXPECT_THAT(line, EndsWith(" target=\"/? status=200?time=??\""));
}

TEST(LogLine, IsCut) {
  EXPECT_THAT(MakeLogLine("info", "x", {{"a", std::string(5000, 'a')}}).size(),
              testing::Lt(300u));
}

}  // namespace
}  // namespace graspdb
