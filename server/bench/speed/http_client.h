#pragma once

#include <memory>
#include <string>

#include "engine/base/result.h"

namespace graspdb {

/** An HTTP client on one connection to a server on this machine. For one
 thread. */
class BenchClient {
 public:
  explicit BenchClient(int port);
  ~BenchClient();
  BenchClient(BenchClient&&) noexcept;

  /** The body of a successful answer. @retval kInternal for any other. */
  Result<std::string> Get(const std::string& target);
  Result<std::string> Post(const std::string& target, const std::string& body);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspdb
