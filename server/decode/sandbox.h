#pragma once

#include <cstdint>
#include <string>

#include "engine/base/result.h"

namespace graspdb {

struct SandboxLimits {
  int64_t memory_bytes{int64_t{1} << 30};  ///< Of address space.
  int64_t cpu_seconds{11};
};

/** Gives up, for good, whatever decoding a mesh does not need: memory and time
 beyond the limits, new files, core dumps, new privileges, the whole file system
 (landlock), and every system call but reading and writing what is open already,
 memory and time (seccomp). Refused calls fail with EPERM.
 @returns how the process is confined: "landlock and seccomp", or "seccomp" on a
   kernel without landlock, where seccomp alone denies opening files.
 @retval kInternal when the kernel does not let itself be asked. */
Result<std::string> EnterSandbox(const SandboxLimits& limits);

/** Tries ten system calls that the sandbox must refuse, and prints a line for
 each on standard output. Call it inside the sandbox.
 @returns the number that were not refused. */
int ProbeSandbox();

}  // namespace graspdb
