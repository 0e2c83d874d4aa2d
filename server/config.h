#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "engine/base/result.h"

namespace graspdb {

/** How `graspdb serve` serves. */
struct ServerConfig {
  std::string host{"127.0.0.1"};
  int port{8080};           ///< 0: any free one.
  std::string port_file;    ///< Where to write the port; empty: nowhere.
  size_t http_threads{64};  ///< Connections served at the same time.
  int64_t max_upload_bytes{64 << 20};
  std::chrono::seconds default_wait{60};  ///< Of POST /v1/grasps.
};

/** Reads a TOML file of settings, each as the environment variable GRASPDB_NAME
 that it stands for, unless that variable is set: flags go before environment,
 environment before file.
 @retval kInvalidArgument naming the line or setting at fault. */
Result<void> LoadConfigFile(const std::string& path);

}  // namespace graspdb
