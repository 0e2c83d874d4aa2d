#pragma once

#include <memory>
#include <string>
#include <vector>

#include <sys/types.h>

#include "engine/base/result.h"

namespace graspdb {

/** Removes a database file that nobody has open, with what lies beside it. */
void RemoveDatabase(const std::string& path);

/** This very program, serving a database in a process of its own. */
class ServerProcess {
 public:
  /** Starts it and waits until it listens.
   @param db  A database file that no one else serves; its log goes beside it.
   @param options  More of `graspdb serve`'s.
   @retval kInternal when it does not come up. */
  static Result<std::unique_ptr<ServerProcess>> Start(
      const std::string& db, const std::vector<std::string>& options);
  /** Asks it to end and waits for that. */
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  int port() const { return port_; }
  /** From being started to the first answer on /healthz, s. */
  double start_seconds() const { return start_seconds_; }
  /** The most memory that it has had resident, bytes; 0 when unknown. */
  int64_t CalcPeakMemory() const;

 private:
  ServerProcess() = default;

  pid_t pid_{-1};
  int port_{0};
  double start_seconds_{0.0};
};

}  // namespace graspdb
