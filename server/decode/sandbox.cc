#include "server/decode/sandbox.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <string_view>

#include <fcntl.h>
#include <linux/landlock.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

// Sanitizers reserve terabytes of address space and look at memory through a
// pipe; a program built with them is for tests only.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define GRASPDB_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define GRASPDB_SANITIZED 1
#endif
#endif

namespace graspdb {
namespace {

Error MakeError(const std::string& what, int error_number) {
  return Error{ErrorCode::kInternal,
               "the mesh decoder cannot be confined: " + what + ": " +
                   std::strerror(error_number),
               "Run on a kernel with seccomp, or decode files that you trust "
               "without a sandbox: --allow-unsandboxed."};
}

Result<void> LimitResources(const SandboxLimits& limits) {
  struct {
    const char* name;
    __rlimit_resource resource;
    int64_t value;
  } const resources[] = {
#ifndef GRASPDB_SANITIZED
      {"memory", RLIMIT_AS, limits.memory_bytes},
      {"open files", RLIMIT_NOFILE, 0},
#endif
      {"processor time", RLIMIT_CPU, limits.cpu_seconds},
      {"core dumps", RLIMIT_CORE, 0},
  };
  for (const auto& [name, resource, value] : resources) {
    const auto limit = static_cast<rlim_t>(value);
    const rlimit both{limit, limit};
    if (setrlimit(resource, &both) != 0) return MakeError(name, errno);
  }
  return {};
}

// The kernel's struct as of landlock 6; older kernels ignore zeros behind the
// fields they know.
struct LandlockRules {
  uint64_t file_system;
  uint64_t network;
  uint64_t scope;
};

// Denies the whole file system and, where known, the network and signals.
// @returns false on a kernel without landlock.
Result<bool> EnterLandlock() {
  const long version = syscall(SYS_landlock_create_ruleset, nullptr, 0,
                               LANDLOCK_CREATE_RULESET_VERSION);
  if (version < 1) return false;
  LandlockRules rules{(uint64_t{1} << 13) - 1, 0, 0};
  if (version >= 2) rules.file_system |= uint64_t{1} << 13;  // Refer.
  if (version >= 3) rules.file_system |= uint64_t{1} << 14;  // Truncate.
  if (version >= 4) rules.network = 3;                       // Bind, connect.
  if (version >= 5) rules.file_system |= uint64_t{1} << 15;  // Device ioctl.
  if (version >= 6) rules.scope = 3;  // Abstract sockets, signals.
  const long ruleset =
      syscall(SYS_landlock_create_ruleset, &rules, sizeof(rules), 0);
  if (ruleset < 0) return MakeError("landlock rules", errno);
  const long restricted = syscall(SYS_landlock_restrict_self, ruleset, 0);
  const int error_number = errno;
  close(static_cast<int>(ruleset));
  if (restricted != 0) return MakeError("landlock", error_number);
  return true;
}

Result<void> EnterSeccomp() {
  scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
  if (filter == nullptr) return MakeError("seccomp filter", ENOMEM);
  // What malloc, exceptions and the end of a process need.
  int status = 0;
  for (const int call : {
#ifdef GRASPDB_SANITIZED
           SCMP_SYS(pipe), SCMP_SYS(pipe2), SCMP_SYS(close),
           SCMP_SYS(sigaltstack),
#endif
           SCMP_SYS(read), SCMP_SYS(write), SCMP_SYS(munmap), SCMP_SYS(mremap),
           SCMP_SYS(brk), SCMP_SYS(madvise), SCMP_SYS(futex),
           SCMP_SYS(clock_gettime), SCMP_SYS(gettimeofday), SCMP_SYS(getrandom),
           SCMP_SYS(rt_sigreturn), SCMP_SYS(exit), SCMP_SYS(exit_group)}) {
    if (status == 0) {
      status = seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 0);
    }
  }
  // No new memory is ever executable.
  for (const int call : {SCMP_SYS(mmap), SCMP_SYS(mprotect)}) {
    if (status == 0) {
      status = seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 1,
                                SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
    }
  }
  if (status == 0) status = seccomp_load(filter);
  seccomp_release(filter);
  if (status != 0) return MakeError("seccomp", -status);
  return {};
}

// Without the standard streams, which ask for the file's status first.
void Print(std::initializer_list<std::string_view> words) {
  for (const std::string_view word : words) {
    if (write(STDOUT_FILENO, word.data(), word.size()) < 0) return;
  }
}

}  // namespace

Result<std::string> EnterSandbox(const SandboxLimits& limits) {
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      prctl(PR_SET_DUMPABLE, 0, 0, 0, 0) != 0) {
    return MakeError("privileges", errno);
  }
  GRASPDB_TRY(has_landlock, EnterLandlock());
  GRASPDB_TRY_VOID(LimitResources(limits));
  GRASPDB_TRY_VOID(EnterSeccomp());
  return std::string(has_landlock ? "landlock and seccomp" : "seccomp");
}

int ProbeSandbox() {
  constexpr char kPath[] = "/tmp/graspdb-decode-probe";
  struct {
    const char* name;
    long result;
    int error_number;
  } const attempts[] = {
      {"open", syscall(SYS_openat, AT_FDCWD, "/etc/passwd", O_RDONLY), errno},
      {"socket", syscall(SYS_socket, AF_INET, SOCK_STREAM, 0), errno},
      {"execve", syscall(SYS_execve, "/nonexistent/program", nullptr, nullptr),
       errno},
      {"fork", syscall(SYS_clone, SIGCHLD, nullptr, nullptr, nullptr, 0),
       errno},
      {"kill", syscall(SYS_kill, getpid(), 0), errno},
      {"ptrace", syscall(SYS_ptrace, PTRACE_TRACEME, 0, nullptr, nullptr),
       errno},
      {"chmod", syscall(SYS_fchmodat, AT_FDCWD, kPath, 0600), errno},
      {"unlink", syscall(SYS_unlinkat, AT_FDCWD, kPath, 0), errno},
      {"mkdir", syscall(SYS_mkdirat, AT_FDCWD, kPath, 0700), errno},
      {"symlink", syscall(SYS_symlinkat, kPath, AT_FDCWD, kPath), errno},
  };
  int allowed = 0;
  for (const auto& [name, result, error_number] : attempts) {
    const bool blocked =
        result < 0 && (error_number == EPERM || error_number == EACCES);
    if (!blocked) ++allowed;
    Print({name, blocked ? ": blocked\n" : ": ALLOWED\n"});
  }
  return allowed;
}

}  // namespace graspdb
