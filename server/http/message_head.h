#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "server/http/limits.h"
#include "server/http/problem.h"

namespace graspdb {

/** The head of a request, checked more strictly than RFC 9112 asks, so that no
 two parties can disagree where a message ends. */
struct MessageHead {
  std::string method;
  std::string target;  ///< Origin form, begins with "/".
  bool http_1_0{false};
  std::map<std::string, std::string> fields;  ///< Names in lower case.
  size_t content_length{0};
  bool chunked{false};

  bool HasBody() const { return chunked || content_length > 0; }
};

/** Why a head is refused. */
struct HeadFault {
  HttpFault fault{HttpFault::kMalformedRequest};
  std::string detail;

  bool operator==(const HeadFault&) const = default;
};

/** Checks a head: everything up to and including the empty line.
 Refused are bare CR or LF, control characters, folded lines, blanks around
 field names, Content-Length repeated, not decimal or beside Transfer-Encoding,
 any Transfer-Encoding but "chunked", a Host missing (HTTP/1.1) or repeated,
 targets not in origin form, versions but 1.0 and 1.1, and whatever exceeds the
 limits. A repeated field of another name keeps its first value. */
std::variant<MessageHead, HeadFault> ParseHead(std::string_view head,
                                               const HttpLimits& limits);

}  // namespace graspdb
