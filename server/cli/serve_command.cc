#include "server/cli/subcommands.h"

#include <fmt/format.h>

#include "server/config.h"
#include "server/http/http_server.h"

namespace graspdb {

namespace {

void PrintSettings(const Options& options, const ServerConfig& config) {
  fmt::print(stderr,
             "graspdb: host {}, port {}, threads {}, http-threads {}, "
             "max-upload-bytes {}, max-queued-jobs {}, max-backups {}, "
             "wait {}{}\n",
             config.host, config.port, options.threads, config.http_threads,
             config.max_upload_bytes, options.max_queued_jobs,
             options.max_backups, config.default_wait.count(),
             options.allow_unsandboxed ? ", allow-unsandboxed" : "");
}

}  // namespace

void AddServe(Subcommands& commands) {
  CLI::App* command =
      commands.Add("serve", "Serve the database over HTTP.",
                   "graspdb serve --db graspdb.db --port 8080", Source::kFile);
  commands.AddEngineOptions(command);
  const auto config = Share<ServerConfig>();
  const auto wait = std::make_shared<int>(60);
  AddSetting(command, "--host", config->host, "address")->capture_default_str();
  AddSetting(command, "--port", config->port, "port; 0: any free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  AddSetting(command, "--port-file", config->port_file,
             "file to write the port to");
  AddSetting(command, "--http-threads", config->http_threads,
             "connections served at the same time")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  AddSetting(command, "--max-upload-bytes", config->max_upload_bytes,
             "largest mesh")
      ->check(CLI::Range(int64_t{1}, int64_t{1} << 40))
      ->capture_default_str();
  AddSetting(command, "--max-queued-jobs", commands.options.max_queued_jobs,
             "jobs that may wait, slow ones and others each")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  AddSetting(command, "--max-backups", commands.options.max_backups,
             "backups that are kept in DATABASE.backups")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  AddSetting(command, "--wait", *wait, "seconds that POST /v1/grasps waits")
      ->check(CLI::Range(0, 600))
      ->capture_default_str();
  command->callback([&commands, config, wait] {
    commands.action = [config, wait](Program& program) -> Result<int> {
      GRASPDB_TRY_VOID(CheckAddress(*config));
      program.options().max_mesh_bytes = config->max_upload_bytes;
      GRASPDB_TRY(service, program.OpenService(Store::OpenMode::kOpenOrCreate));
      config->default_wait = std::chrono::seconds(*wait);
      GRASPDB_TRY(confinement, service->CheckDecoder());
      fmt::print(stderr, "graspdb {}: database {}, decoder confined by {}\n",
                 EngineVersion(), program.options().db, confinement);
      PrintSettings(program.options(), *config);
      return RunServer(*service, *config);
    };
  });
}

}  // namespace graspdb
