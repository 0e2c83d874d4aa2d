// What of a request is taken apart before anyone looks at it: heads, targets,
// queries, forms. The first byte chooses.

#include "engine/base/utf8.h"
#include "server/http/message_head.h"
#include "server/http/multipart.h"
#include "server/http/query.h"
#include "server/http/target.h"
#include "tests/fuzz/fuzz_target.h"

namespace graspdb::fuzz {
namespace {

void FuzzTarget(std::string_view text) {
  if (!text.starts_with('/')) return;  // ParseHead() lets no other pass.
  const auto target = ParseTarget(text);
  if (!target) {
    Require(!target.error().message.empty());
    return;
  }
  // What was read is written and read again.
  std::string again;
  for (const std::string& segment : target->segments) {
    Require(IsUtf8(segment));
    again.push_back('/');
    again.append(EncodePercent(segment));
  }
  if (again.empty()) again.push_back('/');
  char separator = '?';
  for (const auto& [name, value] : target->query) {
    again.push_back(separator);
    again.append(EncodePercent(name)).push_back('=');
    again.append(EncodePercent(value));
    separator = '&';
  }
  const auto same = ParseTarget(again);
  Require(same.has_value() && *same == *target);
  QueryReader query(target->query);
  query.Text("part");
  query.Integer("limit", 1, 1000);
  query.Number("min_epsilon", 0.0, 1.0);
  query.Boolean("cascade");
  query.Choice("sort", {"epsilon", "merit"});
  (void)query.Finish().has_value();
}

void FuzzHead(std::string_view text) {
  const HttpLimits limits;
  const auto parsed = ParseHead(text, limits);
  if (const auto* head = std::get_if<MessageHead>(&parsed)) {
    Require(!head->method.empty() && head->target.starts_with("/"));
    Require(!(head->chunked && head->content_length > 0));
    for (const auto& [name, value] : head->fields) {
      Require(name.find_first_of("\r\n") == std::string::npos);
      Require(value.find_first_of("\r\n") == std::string::npos);
    }
  }
}

void FuzzForm(std::string_view text) {
  const size_t line = text.find('\n');
  if (line == std::string_view::npos) return;
  const auto form =
      ParseMultipart(text.substr(line + 1), text.substr(0, line), HttpLimits());
  if (!form) Require(!form.error().message.empty());
}

}  // namespace

std::vector<std::string> MakeSeeds() {
  return {
      "t/v1/grasps?category=mug&part=body&min_epsilon=0.05&limit=20",
      "t/v1/parts/a%20b%2Fc?x=%C3%A4&y=1+2",
      "hGET /v1/hands HTTP/1.1\r\nHost: a\r\nAccept: */*\r\n\r\n",
      "hPOST /v1/objects HTTP/1.1\r\nHost: a\r\nContent-Length: 12\r\n"
      "Content-Type: model/obj\r\nPrefer: wait=3\r\n\r\n",
      "hPOST / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n",
      "fmultipart/form-data; boundary=x\n--x\r\nContent-Disposition: "
      "form-data; "
      "name=\"mesh\"; filename=\"a.obj\"\r\n\r\nv 0 0 0\r\n--x\r\n"
      "Content-Disposition: form-data; name=\"units\"\r\n\r\nmm\r\n--x--\r\n"};
}

}  // namespace graspdb::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace graspdb::fuzz;
  if (size == 0) return 0;
  const auto text = AsText(data + 1, size - 1);
  if (data[0] == 't') FuzzTarget(text);
  if (data[0] == 'h') FuzzHead(text);
  if (data[0] == 'f') FuzzForm(text);
  return 0;
}
