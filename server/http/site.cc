#include "server/http/site.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>

#include "server/http/field_text.h"

namespace graspdb {
namespace {

std::string FindField(const MessageHead& head, const std::string& name) {
  const auto found = head.fields.find(name);
  return found == head.fields.end() ? "" : ToLowerAscii(found->second);
}

// Of HOST, HOST:PORT and [HOST]:PORT.
std::string CutPort(const std::string& authority) {
  if (authority.starts_with('[')) {
    const size_t end = std::min(authority.find(']'), authority.size());
    return authority.substr(1, end - 1);
  }
  return authority.substr(0, authority.find(':'));
}

// Of SCHEME://HOST:PORT; empty for "null".
std::string FindOriginHost(const std::string& origin) {
  const size_t slashes = origin.find("://");
  return slashes == std::string::npos ? ""
                                      : CutPort(origin.substr(slashes + 3));
}

bool IsAddress(const std::string& host) {
  std::array<unsigned char, sizeof(in6_addr)> address{};
  return inet_pton(AF_INET, host.c_str(), address.data()) == 1 ||
         inet_pton(AF_INET6, host.c_str(), address.data()) == 1;
}

bool ChangesSomething(const std::string& method) {
  return method != "GET" && method != "HEAD";
}

}  // namespace

bool IsLoopback(std::string_view host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

std::optional<std::string> FindForeignSite(const MessageHead& head,
                                           bool for_this_machine) {
  const std::string host = CutPort(FindField(head, "host"));
  const bool local = host.empty() || IsAddress(host) || host == "localhost" ||
                     host.ends_with(".localhost");
  if (for_this_machine && !local) {
    return "This server listens on this machine only, and is not called " +
           host + "; a front sends Host: localhost.";
  }
  const std::string origin = FindField(head, "origin");
  if (origin.empty() || !ChangesSomething(head.method)) return std::nullopt;
  const std::string forwarded = CutPort(FindField(head, "x-forwarded-host"));
  const std::string asked = forwarded.empty() ? host : forwarded;
  if (FindOriginHost(origin) == asked) return std::nullopt;
  return "A page of another site asks for it.";
}

}  // namespace graspdb
