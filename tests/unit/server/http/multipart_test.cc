#include "server/http/multipart.h"

#include <gtest/gtest.h>

namespace graspdb {
namespace {

constexpr char kType[] = "multipart/form-data; boundary=XX";

Result<std::vector<FormPart>> Parse(const std::string& body,
                                    const std::string& type = kType) {
  return ParseMultipart(body, type, HttpLimits{});
}

std::string FilePart(const std::string& content) {
  return "--XX\r\nContent-Disposition: form-data; name=\"mesh\"; "
         "filename=\"a.stl\"\r\nContent-Type: model/stl\r\n\r\n" +
         content + "\r\n";
}

TEST(Multipart, ReadsAFileAndAField) {
  const auto parts = Parse(FilePart("solid") +
                           "--XX\r\nContent-Disposition: form-data; "
                           "name=\"category\"\r\n\r\nmug\r\n--XX--\r\n");
  ASSERT_TRUE(parts);
  ASSERT_EQ(parts->size(), 2);
  EXPECT_EQ(parts->at(0), (FormPart{"mesh", "a.stl", "model/stl", "solid"}));
  EXPECT_EQ(parts->at(1), (FormPart{"category", "", "", "mug"}));
}

TEST(Multipart, ContentMayHoldLineBreaksNulAndHalfABoundary) {
  const std::string content("a\r\n--X\r\n\0--XX\n\r\n", 17);
  const auto parts = Parse(FilePart(content) + "--XX--");
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->at(0).content, content);
}

TEST(Multipart, ContentMayBeEmpty) {
  const auto parts = Parse(FilePart("") + "--XX--\r\n");
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->at(0).content, "");
}

TEST(Multipart, SkipsAPreambleAndAnEpilogue) {
  const auto parts = Parse("hello\r\n" + FilePart("x") + "--XX--\r\nbye");
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->at(0).content, "x");
}

TEST(Multipart, NamesMayHoldQuotesSemicolonsAndAnyCase) {
  const auto parts = Parse(
      "--XX\r\ncontent-disposition: Form-Data; FILENAME=\"a;\\\"b\\\".stl\"; "
      "name=mesh\r\n\r\nx\r\n--XX--");
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->at(0).name, "mesh");
  EXPECT_EQ(parts->at(0).filename, "a;\"b\".stl");
}

TEST(Multipart, AHeadHasALimit) {
  const std::string name(HttpLimits{}.max_form_head_bytes, 'a');
  const auto parts = Parse(
      "--XX\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"" +
      name + "\"\r\n\r\nx\r\n--XX--");
  ASSERT_FALSE(parts);
  EXPECT_EQ(parts.error().code, ErrorCode::kTooLarge);
}

TEST(Multipart, TheBoundaryMayBeQuoted) {
  const auto parts = Parse(
      "--a b\r\nContent-Disposition: form-data; name=n\r\n\r\nv\r\n--a b--",
      "multipart/form-data; charset=utf-8; boundary=\"a b\"");
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->at(0).content, "v");
}

TEST(Multipart, RefusesWhatIsMalformed) {
  const std::string good = FilePart("x") + "--XX--";
  EXPECT_FALSE(Parse(good, "multipart/form-data"));
  EXPECT_FALSE(Parse(good, "multipart/form-data; boundary=YY"));
  EXPECT_FALSE(Parse(""));
  EXPECT_FALSE(Parse("--XX"));
  EXPECT_FALSE(Parse(FilePart("x")));
  EXPECT_FALSE(Parse(FilePart("x") + "--XX"));
  EXPECT_FALSE(Parse("--XX\r\n\r\nx\r\n--XX--"));
  EXPECT_FALSE(Parse("--XX\r\nno colon\r\n\r\nx\r\n--XX--"));
  EXPECT_FALSE(
      Parse("--XX\r\nContent-Disposition: form-data\r\n\r\nx\r\n--XX--"));
  EXPECT_FALSE(
      Parse("--XX\r\nContent-Disposition: attachment; name=a"
            "\r\n\r\nx\r\n--XX--"));
}

TEST(Multipart, EveryTruncationIsRefused) {
  const std::string good = FilePart("x") + FilePart("y") + "--XX--";
  ASSERT_TRUE(Parse(good));
  for (size_t n = 0; n < good.size(); ++n) {
    EXPECT_FALSE(Parse(good.substr(0, n))) << n;
  }
}

TEST(Multipart, TooManyPartsAndTooLongFieldsAreTooLarge) {
  HttpLimits limits;
  limits.max_form_parts = 2;
  limits.max_form_field_bytes = 3;
  const auto field = [](const std::string& value) {
    return "--XX\r\nContent-Disposition: form-data; name=n\r\n\r\n" + value +
           "\r\n";
  };
  const auto code = [&](const std::string& body) {
    const auto parts = ParseMultipart(body + "--XX--", kType, limits);
    return parts ? ErrorCode::kInternal : parts.error().code;
  };
  EXPECT_EQ(code(field("123") + field("123") + field("123")),
            ErrorCode::kTooLarge);
  EXPECT_EQ(code(field("1234")), ErrorCode::kTooLarge);
  EXPECT_EQ(code(field("123") + FilePart("1234")), ErrorCode::kInternal);
}

TEST(FieldParameter, IsFoundAmongOthers) {
  EXPECT_EQ(FindFieldParameter("a/b; c=\"x;d=1\"; d = 2 ; e=3", "d"), "2");
  EXPECT_EQ(FindFieldParameter("a/b; c", "c"), "");
  EXPECT_EQ(FindFieldParameter("a/b", "c"), "");
}

}  // namespace
}  // namespace graspdb
