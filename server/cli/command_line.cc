#include "server/cli/command_line.h"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <functional>
#include <iostream>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "server/cli/backend.h"
#include "server/cli/populate.h"
#include "server/cli/report.h"
#include "server/codec/parameters_json.h"
#include "server/codec/record_json.h"
#include "server/config.h"
#include "server/decode/decode_client.h"
#include "server/http/http_server.h"
#include "server/jobs/service.h"

namespace graspdb {
namespace {

constexpr int kSuccess = 0;
constexpr int kDamaged = 1;
constexpr int kUserError = 2;

// What all subcommands share.
struct Options {
  std::string db{"graspdb.db"};
  std::string server;
  std::string config;
  std::string decoder;
  bool allow_unsandboxed{false};
  int threads{0};
  bool json{false};
};

// The program while it runs one subcommand.
class Program {
 public:
  const Options& options() const { return options_; }
  Options& options() { return options_; }

  Result<Service*> OpenService(Store::OpenMode mode) {
    if (service_) return service_.get();
    GRASPDB_TRY(store, Store::Open(options_.db, mode));
    DecoderOptions decoder;
    decoder.helper = options_.decoder;
    decoder.allow_unsandboxed = options_.allow_unsandboxed;
    ServiceOptions service;
    service.threads = options_.threads;
    service_ = std::make_unique<Service>(
        std::move(store), std::make_unique<Decoder>(decoder), service);
    return service_.get();
  }

  // The server that --server names, else the database file.
  Result<Backend*> OpenBackend() {
    if (options_.server.empty()) {
      GRASPDB_TRY(service, OpenService(Store::OpenMode::kMustExist));
      backend_ = MakeLocalBackend(*service);
    } else {
      GRASPDB_TRY(remote, MakeRemoteBackend(options_.server));
      backend_ = std::move(remote);
    }
    return backend_.get();
  }

  // The JSON itself, or what a person reads of it.
  int Print(const std::string& json,
            const std::function<std::string(const std::string&)>& report) {
    const std::string text = options_.json ? json + "\n" : report(json);
    std::fwrite(text.data(), 1, text.size(), stdout);
    if (std::fflush(stdout) == 0) return kSuccess;
    fmt::print(stderr, "graspdb: Standard output cannot be written.\n");
    return kUserError;
  }

 private:
  Options options_;
  std::unique_ptr<Service> service_;
  std::unique_ptr<Backend> backend_;
};

// A subcommand that was parsed, ready to run.
using Action = std::function<Result<int>(Program&)>;

class CommandLine {
 public:
  CommandLine() : app_("A database of robot grasps.", "graspdb") {
    app_.require_subcommand(1);
    app_.set_version_flag("--version", EngineVersion());
    app_.footer(
        "Settings: flags, then GRASPDB_… variables, then the --config file.\n"
        "Example:\n"
        "  graspdb populate data && graspdb grasp mug.stl --category mug");
    AddServe();
    AddPopulate();
    AddGrasp();
    AddQuery();
    AddSegment();
    AddLearn();
    AddVerify();
    AddRender();
    AddCheck();
  }

  int Run(int argc, const char* const* argv) {
    try {
      app_.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      if (error.get_exit_code() == 0) return app_.exit(error);  // --help.
      return Complain({ErrorCode::kInvalidArgument, error.what(),
                       "graspdb --help, graspdb SUBCOMMAND --help"});
    }
    const Result<int> status = action_(program_);
    return status ? *status : Complain(status.error());
  }

  static int Complain(const Error& error) {
    fmt::print(stderr, "graspdb: {}{}\n", error.message,
               error.hint.empty() ? "" : " (" + error.hint + ")");
    return kUserError;
  }

 private:
  // An option that GRASPDB_NAME sets too.
  template <class T>
  static CLI::Option* Add(CLI::App* command, const std::string& flags, T& value,
                          const std::string& description) {
    CLI::Option* option = command->add_option(flags, value, description);
    return SetVariable(option, flags);
  }
  static CLI::Option* SetVariable(CLI::Option* option,
                                  const std::string& flags) {
    std::string name = "GRASPDB_";
    for (const char c : flags.substr(flags.find("--") + 2)) {
      name += c == '-' ? '_' : static_cast<char>(std::toupper(c));
    }
    return option->envname(name);
  }

  CLI::App* AddCommand(const std::string& name, const std::string& description,
                       const std::string& example, bool client) {
    CLI::App* command = app_.add_subcommand(name, description);
    Options& options = program_.options();
    Add(command, "--db", options.db, "database file")->capture_default_str();
    if (client) {
      Add(command, "--server", options.server,
          "URL of a server to ask instead of the file");
    }
    // Read before all else, see RunCommandLine().
    command->add_option("--config", options.config, "TOML file of settings");
    command->add_flag("--json", options.json, "print JSON");
    command->footer("Example:\n  " + example);
    return command;
  }

  void AddEngineOptions(CLI::App* command) {
    Options& options = program_.options();
    Add(command, "--threads", options.threads, "0: as many as cores")
        ->check(CLI::Range(0, 1024));
    Add(command, "--decoder", options.decoder,
        "helper that decodes meshes (default: beside graspdb)");
    SetVariable(
        command->add_flag("--allow-unsandboxed", options.allow_unsandboxed,
                          "decode where the kernel cannot confine"),
        "--allow-unsandboxed");
  }

  static void AddMeshOptions(CLI::App* command, ImportOrder& order,
                             std::string& path) {
    command->add_option("mesh", path, "a mesh or a point cloud; - reads stdin")
        ->required();
    command->add_option("--units", order.units, "m, mm, cm or in (default m)");
    command->add_option("--format", order.format, "obj, stl or ply");
  }

  void AddServe();
  void AddPopulate();
  void AddGrasp();
  void AddQuery();
  void AddSegment();
  void AddLearn();
  void AddVerify();
  void AddRender();
  void AddCheck();

  CLI::App app_;
  Program program_;
  Action action_;
};

// Options live as long as the command line: each Add… keeps its own in a
// shared_ptr that its action owns.
template <class T>
std::shared_ptr<T> Share() {
  return std::make_shared<T>();
}

// A preset's name, or JSON, or a file of JSON, over the defaults.
Result<Parameters> ReadParameters(const std::string& given) {
  if (given.empty() || given == "default") return MakeDefaultParameters();
  if (given == "paper") return MakePaperParameters();
  if (given.front() == '{') return ParametersFromJson(given, Parameters());
  GRASPDB_TRY(text, ReadFileBytes(given));
  return ParametersFromJson(text, Parameters());
}

Result<void> ReadMesh(const std::string& path, ImportOrder& order) {
  GRASPDB_TRY(bytes, ReadFileBytes(path));
  order.bytes = std::move(bytes);
  if (path != "-") order.file_name = path.substr(path.find_last_of('/') + 1);
  return {};
}

Result<void> WriteFileBytes(const std::string& path, const std::string& bytes) {
  if (path == "-") {
    std::fwrite(bytes.data(), 1, bytes.size(), stdout);
    return {};
  }
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), std::ssize(bytes));
  file.close();
  if (file) return {};
  return Error{ErrorCode::kInvalidArgument, path + " cannot be written.",
               "check its folder"};
}

void CommandLine::AddServe() {
  CLI::App* command =
      AddCommand("serve", "Serve the database over HTTP.",
                 "graspdb serve --db graspdb.db --port 8080", false);
  AddEngineOptions(command);
  const auto config = Share<ServerConfig>();
  const auto wait = std::make_shared<int>(60);
  Add(command, "--host", config->host, "address")->capture_default_str();
  Add(command, "--port", config->port, "port; 0: any free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  Add(command, "--port-file", config->port_file, "file to write the port to");
  Add(command, "--http-threads", config->http_threads,
      "connections served at the same time")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  Add(command, "--max-upload-bytes", config->max_upload_bytes, "largest mesh")
      ->capture_default_str();
  Add(command, "--wait", *wait, "seconds that POST /v1/grasps waits")
      ->check(CLI::Range(0, 600))
      ->capture_default_str();
  command->callback([this, config, wait] {
    action_ = [config, wait](Program& program) -> Result<int> {
      GRASPDB_TRY_VOID(CheckAddress(*config));
      GRASPDB_TRY(service, program.OpenService(Store::OpenMode::kOpenOrCreate));
      config->default_wait = std::chrono::seconds(*wait);
      GRASPDB_TRY(confinement, service->CheckDecoder());
      fmt::print(stderr, "graspdb {}: database {}, decoder confined by {}\n",
                 EngineVersion(), program.options().db, confinement);
      return RunServer(*service, *config);
    };
  });
}

void CommandLine::AddPopulate() {
  CLI::App* command = AddCommand(
      "populate", "Bring a data folder into the database and learn from it.",
      "graspdb populate data --db graspdb.db", false);
  AddEngineOptions(command);
  const auto order = Share<PopulateOrder>();
  const auto parameters = Share<std::string>();
  const auto skip = std::make_shared<bool>(false);
  command->add_option("folder", order->folder, "such as data")->required();
  command->add_option("--hand", order->hands, "hands to learn with (all)");
  command->add_option("--seed", order->seed, "")->capture_default_str();
  command->add_option("--parameters", *parameters,
                      "default, paper, JSON or a file of it");
  command->add_flag("--no-learn", *skip, "import only");
  command->callback([this, order, parameters, skip] {
    action_ = [order, parameters, skip](Program& program) -> Result<int> {
      GRASPDB_TRY(read, ReadParameters(*parameters));
      order->parameters = read;
      order->learn = !*skip;
      GRASPDB_TRY(service, program.OpenService(Store::OpenMode::kOpenOrCreate));
      Progress progress(program.options().json);
      GRASPDB_TRY(spaces, Populate(*service, *order, progress));
      return program.Print(spaces, ReportGraspSpaces);
    };
  });
}

void CommandLine::AddGrasp() {
  CLI::App* command = AddCommand(
      "grasp", "Find grasps for a mesh by transfer.",
      "graspdb grasp mug.stl --category mug --units mm --count 10", true);
  AddEngineOptions(command);
  const auto order = Share<TransferOrder>();
  struct Extra {
    std::string path, parameters, stage;
    std::optional<int> count;
    std::optional<double> friction;
  };
  const auto extra = Share<Extra>();
  AddMeshOptions(command, order->mesh, extra->path);
  command->add_option("--category", order->category, "category, or auto")
      ->required();
  command->add_option("--part", order->part_labels, "parts to grasp (all)");
  command->add_option("--task", order->task, "grasp parts that serve it");
  command->add_option("--hand", order->hand, "hand")->capture_default_str();
  command->add_option("--count", extra->count, "most grasps, best first");
  command->add_option("--sources", order->sources, "source grasps per part")
      ->capture_default_str();
  command->add_option("--friction", extra->friction, "coefficient");
  command->add_option("--stage", extra->stage, "assembly (default), transfer");
  command->add_option("--seed", order->seed, "")->capture_default_str();
  command->add_option("--parameters", extra->parameters,
                      "default, paper, JSON or a file of it");
  command->callback([this, order, extra] {
    action_ = [order, extra](Program& program) -> Result<int> {
      GRASPDB_TRY(parameters, ReadParameters(extra->parameters));
      order->parameters = parameters;
      if (extra->friction)
        order->parameters.contact.friction = *extra->friction;
      order->count = extra->count;
      if (!extra->stage.empty()) {
        GRASPDB_TRY(stage, ParseGraspStage(extra->stage));
        order->stage = stage;
      }
      GRASPDB_TRY_VOID(ReadMesh(extra->path, order->mesh));
      GRASPDB_TRY(backend, program.OpenBackend());
      Progress progress(program.options().json);
      GRASPDB_TRY(answer, backend->Grasp(*order, progress));
      return program.Print(answer, ReportTransfer);
    };
  });
}

void CommandLine::AddQuery() {
  CLI::App* command =
      AddCommand("query", "List stored grasps.",
                 "graspdb query --category mug --part handle --limit 5", true);
  struct Given {
    GraspSearch search;
    std::string stage;
    std::string sort{"epsilon"};
  };
  const auto given = Share<Given>();
  GraspQuery& query = given->search.query;
  query.page.limit = 20;
  command->add_option("--category", query.category, "category");
  command->add_option("--part", query.part_labels, "part labels");
  command->add_option("--task", given->search.task, "parts that serve it");
  command->add_option("--hand", query.hand, "hand");
  command->add_option("--object", query.object_id, "object's id");
  command->add_option("--min-epsilon", query.min_epsilon, "least eps");
  command->add_option("--stage", given->stage, "learned, transfer, assembly");
  command->add_option("--sort", given->sort, "epsilon, hybrid, robust, newest")
      ->check(CLI::IsMember({"epsilon", "hybrid", "robust", "newest"}));
  command->add_option("--limit", query.page.limit, "1 to 1000")
      ->capture_default_str();
  command->add_option("--cursor", query.page.cursor, "of the page before");
  command->callback([this, given] {
    action_ = [given](Program& program) -> Result<int> {
      using Sort = GraspQuery::Sort;
      GraspQuery& wanted = given->search.query;
      wanted.sort = given->sort == "hybrid"   ? Sort::kHybrid
                    : given->sort == "robust" ? Sort::kRobust
                    : given->sort == "newest" ? Sort::kNewest
                                              : Sort::kEpsilon;
      if (!given->stage.empty()) {
        GRASPDB_TRY(stage, ParseGraspStage(given->stage));
        wanted.stage = stage;
      }
      GRASPDB_TRY(backend, program.OpenBackend());
      GRASPDB_TRY(list, backend->Query(given->search));
      return program.Print(list, ReportGrasps);
    };
  });
}

void CommandLine::AddSegment() {
  CLI::App* command =
      AddCommand("segment", "Store a mesh and cut it into its parts.",
                 "graspdb segment mug.stl --category mug --units mm", true);
  AddEngineOptions(command);
  const auto order = Share<ImportOrder>();
  const auto path = Share<std::string>();
  AddMeshOptions(command, *order, *path);
  command->add_option("--category", order->category, "category, or auto")
      ->required();
  command->callback([this, order, path] {
    action_ = [order, path](Program& program) -> Result<int> {
      GRASPDB_TRY_VOID(ReadMesh(*path, *order));
      GRASPDB_TRY(backend, program.OpenBackend());
      Progress progress(program.options().json);
      GRASPDB_TRY(object, backend->Segment(*order, progress));
      return program.Print(object, ReportObject);
    };
  });
}

void CommandLine::AddLearn() {
  CLI::App* command =
      AddCommand("learn", "Learn the grasp spaces of a stored object.",
                 "graspdb learn 0198f2c4-… --part handle", true);
  AddEngineOptions(command);
  const auto order = Share<LearnOrder>();
  const auto parameters = Share<std::string>();
  command->add_option("object", order->object_id, "object's id")->required();
  command->add_option("--part", order->part_labels, "parts (all)");
  command->add_option("--hand", order->hands, "hands (all)");
  command->add_option("--seed", order->seed, "")->capture_default_str();
  command->add_option("--parameters", *parameters,
                      "default, paper, JSON or a file of it");
  command->callback([this, order, parameters] {
    action_ = [order, parameters](Program& program) -> Result<int> {
      GRASPDB_TRY(read, ReadParameters(*parameters));
      order->parameters = read;
      GRASPDB_TRY(backend, program.OpenBackend());
      Progress progress(program.options().json);
      GRASPDB_TRY(spaces, backend->Learn(*order, progress));
      return program.Print(spaces, ReportGraspSpaces);
    };
  });
}

void CommandLine::AddVerify() {
  CLI::App* command = AddCommand(
      "verify", "Push on stored grasps in a simulator and keep the verdicts.",
      "graspdb verify --category mug --stage assembly", false);
  AddEngineOptions(command);
  const auto order = Share<VerifyOrder>();
  const auto stage = Share<std::string>();
  GraspQuery& query = order->query;
  command->add_option("--category", query.category, "category");
  command->add_option("--part", query.part_labels, "part labels");
  command->add_option("--hand", query.hand, "hand");
  command->add_option("--object", query.object_id, "object's id");
  command->add_option("--transfer", query.transfer_id, "transfer's id");
  command->add_option("--stage", *stage, "learned, transfer, assembly");
  command
      ->add_option("--limit", order->limit, "most grasps, best first; 0: all")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--again", order->again, "those with a verdict, too");
  command->callback([this, order, stage] {
    action_ = [order, stage](Program& program) -> Result<int> {
      if (!stage->empty()) {
        GRASPDB_TRY(parsed, ParseGraspStage(*stage));
        order->query.stage = parsed;
      }
      GRASPDB_TRY(service, program.OpenService(Store::OpenMode::kMustExist));
      Progress progress(program.options().json);
      ExecutionContext context(
          [&progress](const std::string& what, double share) {
            progress.Report(what, share);
          });
      GRASPDB_TRY(verified, service->VerifyGrasps(*order, context));
      return program.Print(VerificationToJson(verified), ReportVerification);
    };
  });
}

void CommandLine::AddRender() {
  CLI::App* command = AddCommand(
      "render", "Draw an object by parts, or grasps on it, as a PNG file.",
      "graspdb render --transfer 5f2c… --count 12 -o grasps.png", true);
  const auto order = Share<RenderOrder>();
  const auto out = std::make_shared<std::string>("grasps.png");
  CLI::Option_group* what = command->add_option_group("what");
  what->add_option("--grasp", order->grasp_id, "one grasp");
  what->add_option("--transfer", order->transfer_id, "a sheet of its best");
  what->add_option("--object", order->object_id, "an object's parts");
  what->require_option(1);
  command->add_option("--count", order->count, "most grasps on a sheet")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_option("--width", order->width, "pixels, of a cell on a sheet")
      ->check(CLI::Range(64, 4096))
      ->capture_default_str();
  command->add_option("--height", order->height, "likewise")
      ->check(CLI::Range(64, 4096))
      ->capture_default_str();
  command->add_option("-o,--output", *out, "PNG file; - writes to stdout")
      ->capture_default_str();
  command->callback([this, order, out] {
    action_ = [order, out](Program& program) -> Result<int> {
      GRASPDB_TRY(backend, program.OpenBackend());
      GRASPDB_TRY(png, backend->Render(*order));
      GRASPDB_TRY_VOID(WriteFileBytes(*out, png));
      if (*out != "-") fmt::print("{}\n", *out);
      return kSuccess;
    };
  });
}

void CommandLine::AddCheck() {
  CLI::App* command =
      AddCommand("check", "Read the whole database and tell of any damage.",
                 "graspdb check --db graspdb.db", false);
  command->callback([this] {
    action_ = [](Program& program) -> Result<int> {
      GRASPDB_TRY(store, Store::Open(program.options().db,
                                     Store::OpenMode::kMustExist));
      GRASPDB_TRY(report, store->Check());
      const int printed = program.Print(ToJson(report), ReportCheck);
      return report.problems.empty() ? printed : kDamaged;
    };
  });
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
      return CommandLine::Complain(loaded.error());
    }
    return CommandLine().Run(argc, argv);
  } catch (const std::exception& exception) {
    return CommandLine::Complain(
        {ErrorCode::kInternal,
         std::string("This is a bug: ") + exception.what(), "report it"});
  }
}

}  // namespace graspdb
