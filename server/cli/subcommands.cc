#include "server/cli/subcommands.h"

#include <cctype>

namespace graspdb {

CLI::App* Subcommands::Add(const std::string& name,
                           const std::string& description,
                           const std::string& example, Source source) {
  CLI::App* command = app.add_subcommand(name, description);
  if (source != Source::kOwn) {
    AddSetting(command, "--db", options.db, "database file")
        ->capture_default_str();
  }
  if (source == Source::kFileOrServer) {
    AddSetting(command, "--server", options.server,
               "URL of a server to ask instead of the file");
  }
  // Read before all else, see RunCommandLine().
  command->add_option("--config", options.config, "TOML file of settings");
  command->add_flag("--json", options.json, "print JSON");
  command->footer("Example:\n  " + example);
  return command;
}

void Subcommands::AddEngineOptions(CLI::App* command) {
  AddSetting(command, "--threads", options.threads, "0: as many as cores")
      ->check(CLI::Range(0, 1024));
  AddSetting(command, "--decoder", options.decoder,
             "helper that decodes meshes (default: beside graspdb)");
  SetVariable(
      command->add_flag("--allow-unsandboxed", options.allow_unsandboxed,
                        "decode where the kernel cannot confine"),
      "--allow-unsandboxed");
}

CLI::Option* SetVariable(CLI::Option* option, const std::string& flags) {
  std::string name = "GRASPDB_";
  for (const char c : flags.substr(flags.find("--") + 2)) {
    name += c == '-' ? '_' : static_cast<char>(std::toupper(c));
  }
  return option->envname(name);
}

void AddMeshOptions(CLI::App* command, ImportOrder& order, std::string& path) {
  command->add_option("mesh", path, "a mesh or a point cloud; - reads stdin")
      ->required();
  command->add_option("--units", order.units, "m, mm, cm or in (default m)");
  command->add_option("--format", order.format, "obj, stl or ply");
}

}  // namespace graspdb
