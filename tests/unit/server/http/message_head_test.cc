#include "server/http/message_head.h"

#include <gtest/gtest.h>

namespace graspdb {
namespace {

std::variant<MessageHead, HeadFault> Parse(const std::string& head) {
  return ParseHead(head, HttpLimits{});
}

/** A head with the given field lines after Host. */
std::string WithFields(const std::string& lines) {
  return "POST /v1/grasps HTTP/1.1\r\nHost: h\r\n" + lines + "\r\n";
}

bool IsRefused(const std::string& head,
               HttpFault fault = HttpFault::kMalformedRequest) {
  const auto parsed = Parse(head);
  const auto* found = std::get_if<HeadFault>(&parsed);
  return found != nullptr && found->fault == fault;
}

TEST(MessageHead, ReadsMethodTargetAndFields) {
  const auto parsed =
      Parse("GET /a?b=c HTTP/1.1\r\nHost: h\r\nX-A: \t1 2\t \r\n\r\n");
  const auto& head = std::get<MessageHead>(parsed);
  EXPECT_EQ(head.method, "GET");
  EXPECT_EQ(head.target, "/a?b=c");
  EXPECT_EQ(head.fields.at("x-a"), "1 2");
  EXPECT_FALSE(head.HasBody());
  EXPECT_FALSE(head.http_1_0);
}

TEST(MessageHead, ReadsTheLengthOfABody) {
  const auto parsed = Parse(WithFields("content-LENGTH: 0012\r\n"));
  EXPECT_EQ(std::get<MessageHead>(parsed).content_length, 12);
  EXPECT_TRUE(std::get<MessageHead>(parsed).HasBody());
}

TEST(MessageHead, ReadsAChunkedBody) {
  const auto parsed = Parse(WithFields("Transfer-Encoding: Chunked\r\n"));
  EXPECT_TRUE(std::get<MessageHead>(parsed).chunked);
}

TEST(MessageHead, HttpOneZeroNeedsNoHost) {
  const auto parsed = Parse("GET / HTTP/1.0\r\n\r\n");
  EXPECT_TRUE(std::get<MessageHead>(parsed).http_1_0);
}

TEST(MessageHead, RefusesAmbiguousFraming) {
  EXPECT_TRUE(
      IsRefused(WithFields("Content-Length: 1\r\n"
                           "Transfer-Encoding: chunked\r\n")));
  EXPECT_TRUE(
      IsRefused(WithFields("Content-Length: 1\r\nContent-Length: 1\r\n")));
  for (const char* length : {"", "-1", "+1", "1,1", "0x1", "1 2", "1.0",
                             "99999999999999999999999"}) {
    EXPECT_TRUE(IsRefused(
        WithFields(std::string("Content-Length: ") + length + "\r\n")))
        << length;
  }
  for (const char* coding : {"gzip", "gzip, chunked", "chunked, chunked",
                             "xchunked", "identity", "chunke%64"}) {
    EXPECT_TRUE(IsRefused(
        WithFields(std::string("Transfer-Encoding: ") + coding + "\r\n")))
        << coding;
  }
  EXPECT_TRUE(
      IsRefused("POST / HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n"));
}

TEST(MessageHead, RefusesFoldedLinesBareLineEndsAndControls) {
  EXPECT_TRUE(IsRefused(WithFields("X: a\r\n b\r\n")));
  EXPECT_TRUE(IsRefused(WithFields("X: a\nY: b\r\n")));
  EXPECT_TRUE(IsRefused(WithFields("X: a\rb\r\n")));
  EXPECT_TRUE(IsRefused(WithFields(std::string("X: a\0b\r\n", 8))));
  EXPECT_TRUE(IsRefused(WithFields("X : a\r\n")));
  EXPECT_TRUE(IsRefused(WithFields(": a\r\n")));
  EXPECT_TRUE(IsRefused(WithFields("no colon\r\n")));
}

TEST(MessageHead, RefusesBrokenRequestLines) {
  for (const char* line :
       {"", "GET", "GET /", "GET / ", "GET  HTTP/1.1", "GET / HTTP/2.0",
        "GET / HTTP/1.1 ", "GET /a b HTTP/1.1", "GET x HTTP/1.1",
        "GET http://h/ HTTP/1.1", "G(T / HTTP/1.1", "GET /#a HTTP/1.1",
        " GET / HTTP/1.1"}) {
    EXPECT_TRUE(IsRefused(std::string(line) + "\r\nHost: h\r\n\r\n")) << line;
  }
}

TEST(MessageHead, RefusesAHostThatIsMissingOrRepeated) {
  EXPECT_TRUE(IsRefused("GET / HTTP/1.1\r\n\r\n"));
  EXPECT_TRUE(IsRefused(WithFields("Host: i\r\n")));
}

TEST(MessageHead, RefusesAHeadWithoutEnd) {
  EXPECT_TRUE(IsRefused("GET / HTTP/1.0\r\n"));
  EXPECT_TRUE(IsRefused("GET / HTTP/1.0"));
}

TEST(MessageHead, HasLimits) {
  const HttpLimits limits;
  EXPECT_TRUE(IsRefused("GET /" +
                            std::string(limits.max_request_line_bytes, 'a') +
                            " HTTP/1.1\r\nHost: h\r\n\r\n",
                        HttpFault::kUriTooLong));
  EXPECT_TRUE(IsRefused(
      WithFields("X: " + std::string(limits.max_field_bytes, 'a') + "\r\n"),
      HttpFault::kHeaderFieldsTooLarge));
  std::string lines;
  for (size_t i = 1; i < limits.max_fields; ++i) lines += "X: 1\r\n";
  EXPECT_FALSE(IsRefused(WithFields(lines), HttpFault::kHeaderFieldsTooLarge));
  EXPECT_TRUE(IsRefused(WithFields(lines + "X: 1\r\n"),
                        HttpFault::kHeaderFieldsTooLarge));
}

}  // namespace
}  // namespace graspdb
