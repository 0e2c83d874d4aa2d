#include "server/bench/speed/server_process.h"

#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/bench/speed/http_client.h"

namespace graspdb {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kPoll{2};
constexpr std::chrono::seconds kLongestStart{60};
constexpr std::chrono::seconds kLongestEnd{30};

Error MakeStartError(const std::string& why) {
  return Error{ErrorCode::kInternal, "The server does not start: " + why + "."};
}

}  // namespace

void RemoveDatabase(const std::string& path) {
  for (const char* suffix : {"", "-wal", "-shm", ".lock"}) {
    std::error_code none;
    std::filesystem::remove(path + suffix, none);
  }
}

Result<std::unique_ptr<ServerProcess>> ServerProcess::Start(
    const std::string& db, const std::vector<std::string>& options) {
  const std::string port_file = db + ".port";
  const std::string log = db + ".log";
  std::error_code code;
  std::filesystem::remove(port_file, code);
  const auto self = std::filesystem::read_symlink("/proc/self/exe", code);
  if (code) return MakeStartError(code.message());
  std::vector<std::string> words{
      self.string(), "serve", "--db",        db,
      "--port",      "0",     "--port-file", port_file};
  words.insert(words.end(), options.begin(), options.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  std::unique_ptr<ServerProcess> server(new ServerProcess());
  const auto start = Clock::now();
  const int failure = posix_spawn(&server->pid_, argv[0], &actions, nullptr,
                                  argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    server->pid_ = -1;
    return MakeStartError(std::strerror(failure));
  }
  while (Clock::now() - start < kLongestStart) {
    if (std::ifstream file(port_file); file >> server->port_) {
      BenchClient client(server->port_);
      if (client.Get("/healthz")) {
        server->start_seconds_ =
            std::chrono::duration<double>(Clock::now() - start).count();
        return server;
      }
    }
    if (waitpid(server->pid_, nullptr, WNOHANG) == server->pid_) {
      server->pid_ = -1;
      return MakeStartError("see " + log);
    }
    std::this_thread::sleep_for(kPoll);
  }
  return MakeStartError("it took too long");
}

ServerProcess::~ServerProcess() {
  if (pid_ < 0) return;
  kill(pid_, SIGTERM);
  const auto asked = Clock::now();
  while (waitpid(pid_, nullptr, WNOHANG) == 0) {
    if (Clock::now() - asked > kLongestEnd) kill(pid_, SIGKILL);
    std::this_thread::sleep_for(kPoll);
  }
}

int64_t ServerProcess::CalcPeakMemory() const {
  std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
  std::string word;
  while (status >> word) {
    int64_t kibibytes = 0;
    if (word == "VmHWM:" && status >> kibibytes) return 1024 * kibibytes;
  }
  return 0;
}

}  // namespace graspdb
