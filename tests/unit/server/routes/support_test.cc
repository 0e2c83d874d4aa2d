#include "server/routes/support.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace graspdb {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr seconds kOtherwise{60};

seconds WaitOf(const std::string& prefer) {
  HttpRequest request;
  request.headers["prefer"] = prefer;
  return ReadPreferredWait(request, kOtherwise);
}

TEST(PreferredWait, IsTheDefaultWithoutAWish) {
  EXPECT_EQ(ReadPreferredWait({}, kOtherwise), kOtherwise);
}

TEST(PreferredWait, TakesWaitAndRespondAsync) {
  EXPECT_EQ(WaitOf("wait=5"), seconds(5));
  EXPECT_EQ(WaitOf("respond-async"), seconds(0));
  EXPECT_EQ(WaitOf("respond-async, wait=10"), seconds(10));
  EXPECT_EQ(WaitOf("return=minimal; wait=0"), seconds(0));
}

TEST(PreferredWait, HasAnEnd) { EXPECT_EQ(WaitOf("wait=99999"), seconds(600)); }

TEST(PreferredWait, IgnoresWhatItDoesNotUnderstand) {
  for (const char* prefer : {"", "wait", "wait=", "wait=-1", "wait=x",
                             "wait=1.5", "waiting=3", "handling=strict"}) {
    EXPECT_EQ(WaitOf(prefer), kOtherwise) << prefer;
  }
}

TEST(List, IsSplitAtCommas) {
  const TextPairs pairs{{"part", "body, handle,,lid"}};
  QueryReader query(pairs);
  EXPECT_THAT(ReadList(query, "part"), ElementsAre("body", "handle", "lid"));
  EXPECT_THAT(ReadList(query, "task"), IsEmpty());
}

TEST(Seed, IsOneUnlessGiven) {
  const TextPairs none;
  QueryReader absent(none);
  EXPECT_EQ(ReadSeed(absent), 1);
  const TextPairs pairs{{"seed", "9223372036854775807"}};
  QueryReader query(pairs);
  EXPECT_EQ(ReadSeed(query), 9223372036854775807u);
}

TEST(Page, HasADefaultAndLimits) {
  const TextPairs pairs{{"cursor", "abc"}};
  QueryReader query(pairs);
  const PageRequest page = ReadPage(query);
  EXPECT_EQ(page.limit, 100);
  EXPECT_EQ(page.cursor, "abc");
  for (const char* limit : {"0", "1001", "x"}) {
    const TextPairs wrong{{"limit", limit}};
    QueryReader reader(wrong);
    ReadPage(reader);
    EXPECT_FALSE(reader.Finish()) << limit;
  }
}

Result<std::optional<ImportOrder>> Upload(const HttpRequest& request) {
  QueryReader query(request.query);
  return ReadUpload(request, query, {"labels"});
}

TEST(Upload, TakesARawBodyWithItsNameAndType) {
  HttpRequest request;
  request.body = "bytes";
  request.headers["content-type"] = "model/stl";
  request.headers["content-disposition"] = "attachment; filename=\"a.stl\"";
  request.query = {{"units", "mm"}};
  const auto upload = Upload(request);
  ASSERT_TRUE(upload && *upload);
  EXPECT_EQ((*upload)->bytes, "bytes");
  EXPECT_EQ((*upload)->file_name, "a.stl");
  EXPECT_EQ((*upload)->format, "model/stl");
  EXPECT_EQ((*upload)->units, "mm");
}

TEST(Upload, TheTypeThatCurlSendsByDefaultSaysNothing) {
  HttpRequest request;
  request.body = "bytes";
  request.headers["content-type"] = "application/x-www-form-urlencoded";
  EXPECT_EQ((*Upload(request))->format, "");
}

TEST(Upload, AStatedFormatComesFirst) {
  HttpRequest request;
  request.body = "bytes";
  request.headers["content-type"] = "model/stl";
  request.query = {{"format", "ply"}};
  EXPECT_EQ((*Upload(request))->format, "ply");
}

TEST(Upload, TakesTheFormsPartMesh) {
  HttpRequest request;
  request.files = {{"labels", "l.json", "", R"({"face_labels":["lid"]})"},
                   {"mesh", "a.obj", "", "bytes"}};
  const auto upload = Upload(request);
  ASSERT_TRUE(upload && *upload);
  EXPECT_EQ((*upload)->bytes, "bytes");
  EXPECT_EQ((*upload)->file_name, "a.obj");
  WorkSlots slots(1, 0);
  EXPECT_EQ(ReadLabels(request, slots).value(),
            std::vector<std::string>{"lid"});
}

TEST(Upload, ManyLabelsWaitForASlot) {
  std::string labels = "\"lid\"";
  for (int i = 0; i < 20'000; ++i) labels += ",\"lid\"";
  HttpRequest request;
  request.files = {
      {"labels", "l.json", "", "{\"face_labels\":[" + labels + "]}"}};
  WorkSlots slots(1, 0);
  EXPECT_EQ(ReadLabels(request, slots).value().size(), 20'001u);
  const auto taken = slots.Take({});
  EXPECT_EQ(ReadLabels(request, slots).error().code, ErrorCode::kOverloaded);
}

TEST(Upload, AnEmptyFileIsAFile) {
  HttpRequest request;
  request.files = {{"mesh", "a.obj", "", ""}};
  EXPECT_TRUE(Upload(request)->has_value());
}

TEST(Upload, NothingIsNoError) {
  const auto upload = Upload({});
  ASSERT_TRUE(upload);
  EXPECT_FALSE(upload->has_value());
}

TEST(Upload, RefusesOtherAndSecondFiles) {
  HttpRequest request;
  request.files = {{"picture", "a.png", "", "x"}};
  EXPECT_FALSE(Upload(request));
  request.files = {{"mesh", "a.obj", "", "x"}, {"mesh", "b.obj", "", "y"}};
  EXPECT_FALSE(Upload(request));
}

}  // namespace
}  // namespace graspdb
