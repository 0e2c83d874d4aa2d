#include "server/cli/command_line.h"

#include <cstdlib>
#include <exception>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "server/cli/subcommands.h"
#include "server/config.h"

namespace graspdb {
namespace {

int Complain(const Error& error) {
  fmt::print(stderr, "graspdb: {}{}\n", error.message,
             error.hint.empty() ? "" : " (" + error.hint + ")");
  return kUserError;
}

int ParseAndRun(int argc, const char* const* argv) {
  Program program;
  CLI::App app("A database of robot grasps.", "graspdb");
  app.require_subcommand(1);
  app.set_version_flag("--version", EngineVersion());
  app.footer(
      "Settings: flags, then GRASPDB_… variables, then the --config file.\n"
      "Example:\n"
      "  graspdb populate data && graspdb grasp mug.stl --category mug");
  Subcommands commands{app, program.options(), {}};
  for (const auto add :
       {&AddServe, &AddPopulate, &AddGrasp, &AddQuery, &AddSegment, &AddLearn,
        &AddVerify, &AddBench, &AddRender, &AddBackup, &AddCheck}) {
    add(commands);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help.
    return Complain({ErrorCode::kInvalidArgument, error.what(),
                     "graspdb --help, graspdb SUBCOMMAND --help"});
  }
  const Result<int> status = commands.action(program);
  return status ? *status : Complain(status.error());
}

// The file that --config or GRASPDB_CONFIG names; it becomes part of the
// environment, which the command line is parsed over.
Result<void> LoadNamedConfig(int argc, const char* const* argv) {
  const char* variable = std::getenv("GRASPDB_CONFIG");
  std::string path = variable == nullptr ? "" : variable;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--config" && i + 1 < argc) path = argv[i + 1];
    if (argument.starts_with("--config=")) path = argument.substr(9);
  }
  return path.empty() ? Result<void>() : LoadConfigFile(path);
}

}  // namespace

int RunCommandLine(int argc, const char* const* argv) {
  try {
    if (const auto loaded = LoadNamedConfig(argc, argv); !loaded) {
      return Complain(loaded.error());
    }
    return ParseAndRun(argc, argv);
  } catch (const std::exception& exception) {
    return Complain({ErrorCode::kInternal,
                     std::string("This is a bug: ") + exception.what(),
                     "report it"});
  }
}

}  // namespace graspdb
