#include "server/decode/decode_client.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

using Clock = std::chrono::steady_clock;

// More than any hand's.
constexpr std::size_t kMostUrdfBytes = std::size_t{1} << 20;
// More than any mesh within sensible limits needs.
constexpr std::size_t kMostAnswerBytes = std::size_t{512} << 20;
// Between two looks at whether anyone still waits.
constexpr int64_t kStepMilliseconds = 50;

// What a helper reads, in words.
struct Subject {
  const char* name;
  const char* hint;
  const char* field;
};
constexpr Subject kMesh{
    "mesh", "Check the mesh in a mesh editor; decimate or repair it first.",
    "mesh"};
constexpr Subject kUrdf{"URDF", "Check it with check_urdf.", "urdf"};

Error MakeStartError(const std::string& helper, const std::string& why) {
  return Error{
      ErrorCode::kInternal,
      fmt::format("the mesh decoder '{}' cannot be started: {}", helper, why),
      "Install graspdb-decode beside the program."};
}

Error MakeInputError(const Subject& subject, std::string message) {
  return Error{ErrorCode::kUnusableInput, std::move(message), subject.hint,
               subject.field};
}

std::string FindHelper() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return (self.parent_path() / "graspdb-decode").string();
}

class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  ~FileDescriptor() { Close(); }
  int get() const { return fd_; }
  void Close() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }

 private:
  int fd_;
};

// A running helper; killed and waited for at the latest when this ends.
class Child {
 public:
  explicit Child(pid_t pid) : pid_(pid) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() { End(); }

  // @returns the status as waitpid() gives it.
  int End() {
    if (pid_ <= 0) return status_;
    kill(pid_, SIGKILL);  // No news to one that has ended already.
    while (waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status_;
  }

 private:
  pid_t pid_;
  int status_{0};
};

// Huge pages where the kernel lends them: assimp fills 16 MiB per file, and a
// page fault for every 4 KiB of that costs more than a mesh does.
constexpr const char* kHelperEnvironment[] = {
    "GLIBC_TUNABLES=glibc.malloc.hugetlb=1", nullptr};

// Starts the helper with the socket as its standard input and output, and with
// no other open file, nothing else in its environment and no ignored or blocked
// signal.
// @returns 0 or the error's number.
int Spawn(const std::vector<std::string>& command, int socket, pid_t* pid) {
  std::vector<char*> argv;
  for (const std::string& word : command) {
    argv.push_back(const_cast<char*>(word.c_str()));
  }
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, socket, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, STDIN_FILENO, STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null",
                                   O_WRONLY, 0);
  posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);

  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t signals;
  sigemptyset(&signals);
  posix_spawnattr_setsigmask(&attributes, &signals);
  sigfillset(&signals);
  posix_spawnattr_setsigdefault(&attributes, &signals);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);

  const int error_number =
      posix_spawn(pid, argv[0], &actions, &attributes, argv.data(),
                  const_cast<char**>(kHelperEnvironment));
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return error_number;
}

enum class TalkEnd { kAnswered, kDeadline, kTooMuch, kCancelled };

// Sends both pieces and collects the answer, whichever way is open.
TalkEnd Talk(int socket, std::span<const uint8_t> head,
             std::span<const uint8_t> body, Clock::time_point deadline,
             const ExecutionContext& context, std::vector<uint8_t>* answer) {
  bool sending = true;
  while (true) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) return TalkEnd::kDeadline;
    if (context.Cancelled()) return TalkEnd::kCancelled;
    pollfd poll_fd{socket, static_cast<short>(POLLIN | (sending ? POLLOUT : 0)),
                   0};
    const auto timeout = std::min<int64_t>(left.count(), kStepMilliseconds);
    if (poll(&poll_fd, 1, static_cast<int>(timeout)) <= 0) continue;
    if (sending && (poll_fd.revents & POLLOUT)) {
      std::span<const uint8_t>& piece = head.empty() ? body : head;
      const ssize_t put =
          send(socket, piece.data(), piece.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (put >= 0) piece = piece.subspan(static_cast<std::size_t>(put));
      const bool broken = put < 0 && errno != EAGAIN && errno != EINTR;
      if (broken || (head.empty() && body.empty())) {
        shutdown(socket, SHUT_WR);
        sending = false;
      }
    }
    if (poll_fd.revents & (POLLIN | POLLHUP | POLLERR)) {
      const std::size_t size = answer->size();
      answer->resize(size + (1 << 18));
      const ssize_t got =
          recv(socket, answer->data() + size, 1 << 18, MSG_DONTWAIT);
      answer->resize(size +
                     static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
      if (got == 0) return TalkEnd::kAnswered;
      if (got < 0 && errno != EAGAIN && errno != EINTR) {
        return TalkEnd::kAnswered;
      }
      if (answer->size() > kMostAnswerBytes) return TalkEnd::kTooMuch;
    }
  }
}

// Without an answer.
Error DescribeEnd(int status, const DecoderOptions& options,
                  const Subject& subject, DecodeCounts& counts) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
    ++counts.timed_out;
    return MakeInputError(
        subject, fmt::format("the decoder gave up after {:.3g} s of computing",
                             options.deadline));
  }
  if (WIFSIGNALED(status)) {
    ++counts.crashed;
    return MakeInputError(
        subject, fmt::format("the decoder crashed on the {} (signal {})",
                             subject.name, WTERMSIG(status)));
  }
  // What a shell and the dynamic linker say about a program that cannot run.
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127) {
    ++counts.unstarted;
    return MakeStartError(options.helper, "a library is missing");
  }
  ++counts.crashed;
  return MakeInputError(subject, "the decoder stopped without an answer");
}

// @param parse  Takes the answer's bytes apart: an optional Result<T>, see
//   decode_protocol.h.
template <class Parse>
auto RunHelper(const DecoderOptions& options, const Subject& subject,
               std::span<const uint8_t> head, std::span<const uint8_t> body,
               const Parse& parse, const ExecutionContext& context,
               DecodeCounts& counts) ->
    typename decltype(parse(body))::value_type {
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double>(options.deadline));
  std::vector<std::string> command{
      options.helper, "--memory", std::to_string(options.memory_bytes), "--cpu",
      fmt::format("{:.0f}", std::ceil(options.deadline))};
  if (options.allow_unsandboxed) command.push_back("--allow-unsandboxed");

  int sockets[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0) {
    ++counts.unstarted;
    return MakeStartError(options.helper, std::strerror(errno));
  }
  FileDescriptor ours(sockets[0]);
  FileDescriptor theirs(sockets[1]);
  pid_t pid = -1;
  if (const int error_number = Spawn(command, theirs.get(), &pid)) {
    ++counts.unstarted;
    return MakeStartError(options.helper, std::strerror(error_number));
  }
  Child child(pid);
  theirs.Close();

  std::vector<uint8_t> bytes;
  switch (Talk(ours.get(), head, body, deadline, context, &bytes)) {
    case TalkEnd::kDeadline:
      ++counts.timed_out;
      return MakeInputError(
          subject,
          fmt::format("the decoder gave up after {:.3g} s", options.deadline));
    case TalkEnd::kCancelled:
      return Error{ErrorCode::kCancelled, "The decoding was cancelled."};
    case TalkEnd::kTooMuch:
      ++counts.crashed;
      return MakeInputError(
          subject, fmt::format("what is in the {} is too large", subject.name));
    case TalkEnd::kAnswered:
      break;
  }
  const int status = child.End();
  auto answer = parse(bytes);
  if (!answer) return DescribeEnd(status, options, subject, counts);
  if (answer->has_value()) {
    ++counts.admitted;
  } else if (answer->error().code == ErrorCode::kInternal) {
    ++counts.unstarted;
  } else {
    ++counts.refused;
  }
  return *std::move(answer);
}

}  // namespace

Decoder::Decoder(DecoderOptions options) : options_(std::move(options)) {
  GRASPDB_EXPECTS(options_.deadline > 0.0 && options_.memory_bytes > 0);
  if (options_.helper.empty()) options_.helper = FindHelper();
}

Result<DecodedMesh> Decoder::Decode(std::span<const uint8_t> bytes,
                                    const DecodeRequest& request,
                                    const ExecutionContext& context) const {
  GRASPDB_EXPECTS(!request.metres_per_unit ||
                  (std::isfinite(*request.metres_per_unit) &&
                   *request.metres_per_unit > 0.0));
  GRASPDB_EXPECTS(request.work_triangles >= 4);
  if (static_cast<int64_t>(bytes.size()) > request.limits.max_bytes) {
    return Error{ErrorCode::kTooLarge,
                 fmt::format("the mesh has {} bytes; the limit is {}",
                             bytes.size(), request.limits.max_bytes),
                 "Decimate the mesh first.", "mesh"};
  }
  DecodeCounts counts;
  auto result = RunHelper(options_, kMesh, EncodeRequest(request), bytes,
                          ParseAnswer, context, counts);
  Add(counts);
  GRASPDB_TRY(answer, std::move(result));
  const MassProperties mass = CalcMassProperties(answer.mesh_O);
  return DecodedMesh{std::move(answer.mesh_O),
                     std::move(answer.work_O),
                     std::move(answer.repairs),
                     mass,
                     std::move(answer.format),
                     std::move(answer.cloud),
                     answer.seconds};
}

Result<HandTree> Decoder::DecodeUrdf(const std::string& urdf,
                                     const ExecutionContext& context) const {
  if (urdf.size() > kMostUrdfBytes) {
    return Error{ErrorCode::kTooLarge,
                 fmt::format("the URDF has {} bytes; the limit is {}",
                             urdf.size(), kMostUrdfBytes),
                 "", kUrdf.field};
  }
  DecodeCounts counts;
  auto tree =
      RunHelper(options_, kUrdf, EncodeUrdfRequest(),
                {reinterpret_cast<const uint8_t*>(urdf.data()), urdf.size()},
                ParseHandAnswer, context, counts);
  Add(counts);
  return tree;
}

Result<std::string> Decoder::Check() const {
  constexpr std::string_view kTetrahedron =
      "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\n"
      "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  const std::span bytes(reinterpret_cast<const uint8_t*>(kTetrahedron.data()),
                        kTetrahedron.size());
  DecodeRequest request;
  request.format = MeshFormat::kObj;
  DecodeCounts of_no_account;
  auto answer = RunHelper(options_, kMesh, EncodeRequest(request), bytes,
                          ParseAnswer, ExecutionContext(), of_no_account);
  if (answer) return std::move(answer->confinement);
  Error error = answer.error();
  error.code = ErrorCode::kInternal;
  return error;
}

DecodeCounts Decoder::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void Decoder::Add(const DecodeCounts& counts) const {
  const std::lock_guard lock(mutex_);
  counts_.admitted += counts.admitted;
  counts_.refused += counts.refused;
  counts_.crashed += counts.crashed;
  counts_.timed_out += counts.timed_out;
  counts_.unstarted += counts.unstarted;
}

}  // namespace graspdb
