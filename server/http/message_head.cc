#include "server/http/message_head.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "server/http/field_text.h"

namespace graspdb {
namespace {

using MaybeFault = std::optional<HeadFault>;

HeadFault Malformed(std::string detail) {
  return {HttpFault::kMalformedRequest, std::move(detail)};
}

/** RFC 9110's token characters. */
bool IsToken(std::string_view text) {
  constexpr std::string_view kMarks = "!#$%&'*+-.^_`|~";
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
           (c >= 'A' && c <= 'Z') || kMarks.find(c) != std::string_view::npos;
  });
}

bool HasControls(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && c != '\t') || byte == 0x7F;
  });
}

MaybeFault ParseRequestLine(std::string_view line, const HttpLimits& limits,
                            MessageHead& head) {
  if (line.size() > limits.max_request_line_bytes) {
    return HeadFault{HttpFault::kUriTooLong,
                     fmt::format("A request line has at most {} bytes.",
                                 limits.max_request_line_bytes)};
  }
  const size_t first = line.find(' ');
  const size_t last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) {
    return Malformed("The request line is not METHOD TARGET VERSION.");
  }
  head.method = line.substr(0, first);
  head.target = line.substr(first + 1, last - first - 1);
  const std::string_view version = line.substr(last + 1);
  head.http_1_0 = version == "HTTP/1.0";
  if (!head.http_1_0 && version != "HTTP/1.1") {
    return Malformed("The version is neither HTTP/1.1 nor HTTP/1.0.");
  }
  const bool printable =
      std::all_of(head.target.begin(), head.target.end(), [](char c) {
        return static_cast<unsigned char>(c) > 0x20 && c != 0x7F && c != '#';
      });
  if (!IsToken(head.method) || !head.target.starts_with('/') || !printable) {
    return Malformed("The method or the request target is not well formed.");
  }
  return std::nullopt;
}

MaybeFault ParseField(std::string_view line, const HttpLimits& limits,
                      MessageHead& head) {
  if (line.size() > limits.max_field_bytes) {
    return HeadFault{HttpFault::kHeaderFieldsTooLarge,
                     fmt::format("A header field has at most {} bytes.",
                                 limits.max_field_bytes)};
  }
  const size_t colon = line.find(':');
  if (colon == std::string_view::npos || !IsToken(line.substr(0, colon))) {
    return Malformed("A header field is not NAME: VALUE on one line.");
  }
  const std::string name = ToLowerAscii(line.substr(0, colon));
  const std::string_view value = TrimBlanks(line.substr(colon + 1));
  const bool fresh = head.fields.emplace(name, value).second;
  const bool unique = name == "content-length" || name == "host" ||
                      name == "transfer-encoding" || name == "content-type";
  if (!fresh && unique) {
    return Malformed(fmt::format("The header field {} is repeated.", name));
  }
  return std::nullopt;
}

MaybeFault FindFraming(MessageHead& head) {
  const auto coding = head.fields.find("transfer-encoding");
  const auto length = head.fields.find("content-length");
  if (coding != head.fields.end()) {
    if (length != head.fields.end() || head.http_1_0 ||
        ToLowerAscii(coding->second) != "chunked") {
      return Malformed("Transfer-Encoding is only read as chunked, alone.");
    }
    head.chunked = true;
  } else if (length != head.fields.end()) {
    const std::string& digits = length->second;
    const auto [end, error] = std::from_chars(
        digits.data(), digits.data() + digits.size(), head.content_length, 10);
    if (error != std::errc() || end != digits.data() + digits.size()) {
      return Malformed("Content-Length is not a decimal number.");
    }
  }
  if (!head.http_1_0 && !head.fields.contains("host")) {
    return Malformed("The header field Host is missing.");
  }
  return std::nullopt;
}

}  // namespace

std::variant<MessageHead, HeadFault> ParseHead(std::string_view head,
                                               const HttpLimits& limits) {
  MessageHead parsed;
  bool first = true;
  size_t num_fields = 0;
  for (;;) {
    const size_t end = head.find("\r\n");
    if (end == std::string_view::npos) {
      return Malformed("The request head does not end with an empty line.");
    }
    const std::string_view line = head.substr(0, end);
    head.remove_prefix(end + 2);
    if (line.empty() && !first) break;
    if (HasControls(line)) {
      return Malformed("The request head has control characters.");
    }
    if (!first && ++num_fields > limits.max_fields) {
      return HeadFault{HttpFault::kHeaderFieldsTooLarge,
                       fmt::format("A request has at most {} header fields.",
                                   limits.max_fields)};
    }
    const MaybeFault fault = first ? ParseRequestLine(line, limits, parsed)
                                   : ParseField(line, limits, parsed);
    if (fault) return *fault;
    first = false;
  }
  if (const MaybeFault fault = FindFraming(parsed)) return *fault;
  return parsed;
}

}  // namespace graspdb
