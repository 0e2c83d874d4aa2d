#include "server/http/target.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace graspdb {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

TEST(Target, SplitsThePathAtSlashes) {
  const auto target = ParseTarget("/v1/objects/7/mesh");
  ASSERT_TRUE(target);
  EXPECT_THAT(target->segments, ElementsAre("v1", "objects", "7", "mesh"));
  EXPECT_THAT(target->query, IsEmpty());
}

TEST(Target, RootHasNoSegments) {
  EXPECT_THAT(ParseTarget("/")->segments, IsEmpty());
}

TEST(Target, KeepsEmptySegments) {
  EXPECT_THAT(ParseTarget("/v1//x")->segments, ElementsAre("v1", "", "x"));
  EXPECT_THAT(ParseTarget("/v1/")->segments, ElementsAre("v1", ""));
}

TEST(Target, AnEncodedSlashStaysInItsSegment) {
  EXPECT_THAT(ParseTarget("/v1/a%2Fb")->segments, ElementsAre("v1", "a/b"));
}

TEST(Target, APlusIsASpaceInTheQueryOnly) {
  const auto target = ParseTarget("/a+b?c=d+e");
  EXPECT_THAT(target->segments, ElementsAre("a+b"));
  EXPECT_THAT(target->query, ElementsAre(Pair("c", "d e")));
}

TEST(Target, KeepsRepeatedAndEmptyQueryParameters) {
  const auto target = ParseTarget("/?a=1&a=1&b&=2&&c=x=y");
  EXPECT_THAT(target->query,
              ElementsAre(Pair("a", "1"), Pair("a", "1"), Pair("b", ""),
                          Pair("", "2"), Pair("c", "x=y")));
}

TEST(Target, RefusesBrokenEscapesNulAndBytesThatAreNoUtf8) {
  for (const char* target : {"/%", "/%4", "/%zz", "/%+1", "/%00", "/%ff",
                             "/%c0%80", "/%ed%a0%80", "/x?y=%fe", "/x?%=1"}) {
    EXPECT_FALSE(ParseTarget(target)) << target;
  }
}

TEST(Target, EncodingIsUndoneByDecoding) {
  const std::string text = "a b/ü?&=%+\x01~";
  EXPECT_EQ(EncodePercent("a b/~"), "a%20b%2F~");
  EXPECT_EQ(*DecodePercent(EncodePercent(text), true), text);
}

}  // namespace
}  // namespace graspdb
