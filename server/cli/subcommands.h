#pragma once

#include <functional>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "engine/base/result.h"
#include "server/cli/program.h"

namespace graspdb {

/** A subcommand that was parsed, ready to run. @returns the exit status. */
using Action = std::function<Result<int>(Program&)>;

/** What a subcommand works on. */
enum class Source {
  kOwn,           ///< Files of its own.
  kFile,          ///< A database file, --db.
  kFileOrServer,  ///< That, or the server that --server names.
};

/** What the Add… functions below describe subcommands to. */
struct Subcommands {
  CLI::App& app;
  Options& options;
  Action action;  ///< Of the subcommand that was parsed.

  CLI::App* Add(const std::string& name, const std::string& description,
                const std::string& example, Source source);
  void AddEngineOptions(CLI::App* command);
};

// Each in <name>_command.cc.
void AddServe(Subcommands& commands);
void AddPopulate(Subcommands& commands);
void AddGrasp(Subcommands& commands);
void AddQuery(Subcommands& commands);
void AddSegment(Subcommands& commands);
void AddLearn(Subcommands& commands);
void AddVerify(Subcommands& commands);
void AddBench(Subcommands& commands);
void AddRender(Subcommands& commands);
void AddBackup(Subcommands& commands);
void AddCheck(Subcommands& commands);

/** Makes GRASPDB_NAME set an option --name, too. */
CLI::Option* SetVariable(CLI::Option* option, const std::string& flags);

/** An option that GRASPDB_NAME sets too. */
template <class T>
CLI::Option* AddSetting(CLI::App* command, const std::string& flags, T& value,
                        const std::string& description) {
  return SetVariable(command->add_option(flags, value, description), flags);
}

/** The mesh that a subcommand is about. */
void AddMeshOptions(CLI::App* command, ImportOrder& order, std::string& path);

/** Options live as long as the command line: each Add… keeps its own in a
 shared_ptr that its action owns. */
template <class T>
std::shared_ptr<T> Share() {
  return std::make_shared<T>();
}

}  // namespace graspdb
