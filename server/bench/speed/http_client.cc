#include "server/bench/speed/http_client.h"

#include <fmt/format.h>

// Last: the system headers that it includes define _res, a name of Eigen's.
#include <httplib.h>

namespace graspdb {
namespace {

constexpr time_t kReadSeconds = 600;

Result<std::string> Check(const httplib::Result& result,
                          const std::string& target) {
  if (result && result->status < 300) return result->body;
  return Error{
      ErrorCode::kInternal,
      fmt::format("The server answered {} with {}.", target,
                  result ? fmt::format("{} {}", result->status, result->body)
                         : httplib::to_string(result.error()))};
}

}  // namespace

struct BenchClient::Impl {
  explicit Impl(int port) : client("127.0.0.1", port) {
    client.set_keep_alive(true);
    client.set_tcp_nodelay(true);
    client.set_read_timeout(kReadSeconds);
  }
  httplib::Client client;
};

BenchClient::BenchClient(int port) : impl_(std::make_unique<Impl>(port)) {}
BenchClient::~BenchClient() = default;
BenchClient::BenchClient(BenchClient&&) noexcept = default;

Result<std::string> BenchClient::Get(const std::string& target) {
  return Check(impl_->client.Get(target), target);
}

Result<std::string> BenchClient::Post(const std::string& target,
                                      const std::string& body) {
  return Check(
      impl_->client.Post(target, httplib::Headers{{"Prefer", "wait=600"}}, body,
                         "application/octet-stream"),
      target);
}

}  // namespace graspdb
