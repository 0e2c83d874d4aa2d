#include <fmt/format.h>

#include "server/bench/html_report.h"
#include "server/bench/paper_bench.h"
#include "server/bench/speed/speed_bench.h"
#include "server/cli/progress.h"
#include "server/cli/subcommands.h"

namespace graspdb {

namespace {

struct BenchOptions {
  PaperBenchOrder order;
  std::string what;
  std::vector<std::string> presets{"default"};
  bool no_physical{false};
  bool ablations{false};
};

Result<int> BenchPaper(Program& program, BenchOptions& given,
                       const OpenService& open, ExecutionContext& context) {
  PaperBenchOrder& order = given.order;
  for (const std::string& preset : given.presets) {
    GRASPDB_TRY(parameters, ReadParameters(preset));
    order.variants.push_back({preset, parameters});
  }
  if (given.ablations) order.ablations = MakeAblations();
  order.physical = !given.no_physical;
  GRASPDB_TRY(report, RunPaperBench(order, open, context));
  return program.Print(DumpJson(report), [&](const std::string&) {
    return MakeTextReport(report) +
           fmt::format("{0}/paper.html, {0}/paper.json\n", order.out);
  });
}

Result<int> BenchSpeed(Program& program, const BenchOptions& given,
                       const OpenService& open, ExecutionContext& context) {
  const Options& options = program.options();
  SpeedBenchOrder order;
  order.data = given.order.data;
  order.out = given.order.out;
  order.quick = given.order.quick;
  order.seed = given.order.seed;
  if (given.presets.size() != 1) {
    return Error{ErrorCode::kInvalidArgument, "bench speed takes one preset."};
  }
  GRASPDB_TRY(parameters, ReadParameters(given.presets.front()));
  order.parameters = parameters;
  order.decoder = MakeDecoderOptions(options);
  order.server_options = {"--threads", std::to_string(options.threads)};
  if (!options.decoder.empty()) {
    order.server_options.insert(order.server_options.end(),
                                {"--decoder", options.decoder});
  }
  if (options.allow_unsandboxed) {
    order.server_options.push_back("--allow-unsandboxed");
  }
  GRASPDB_TRY(report, RunSpeedBench(order, open, context));
  return program.Print(DumpJson(report), [&](const std::string&) {
    return MakeSpeedReport(report) +
           fmt::format("{0}/speed.json, {0}/growth-*.svg\n", order.out);
  });
}

}  // namespace

void AddBench(Subcommands& commands) {
  CLI::App* command = commands.Add(
      "bench",
      "Measure: the paper's tables and figures (paper), or how long everything "
      "takes (speed).",
      "graspdb bench paper --out bench", Source::kOwn);
  commands.AddEngineOptions(command);
  const auto given = Share<BenchOptions>();
  PaperBenchOrder& order = given->order;
  command->add_option("what", given->what, "paper or speed")
      ->required()
      ->check(CLI::IsMember({"paper", "speed"}));
  command->add_option("--data", order.data, "data folder")
      ->capture_default_str();
  command->add_option("--out", order.out, "folder for databases and reports")
      ->capture_default_str();
  command->add_option("--seed", order.seed, "")->capture_default_str();
  command->add_flag("--quick", order.quick,
                    "paper: one novel object a category, eight grasps a part; "
                    "speed: small sizes, few repetitions");
  command
      ->add_option("--preset", given->presets,
                   "default, paper or a file of JSON; paper takes several, "
                   "separated by commas, side by side")
      ->delimiter(',')
      ->capture_default_str();
  CLI::Option_group* paper = command->add_option_group("paper");
  paper->add_option("--objects", order.objects,
                    "more meshes: a folder per category");
  paper->add_option("--units", order.units, "of those meshes")
      ->capture_default_str();
  paper->add_option("--category", order.categories, "categories")
      ->delimiter(',')
      ->capture_default_str();
  paper->add_option("--sources", order.sources, "source grasps per part")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  paper
      ->add_option(
          "--seeding-seconds", order.seeding_seconds,
          "for each way to seed the swarm and each part (10; none when "
          "quick)")
      ->check(CLI::Range(0.0, 3600.0));
  paper->add_flag("--no-physical", given->no_physical, "no simulator");
  paper->add_flag("--ablations", given->ablations,
                  "the default with each of its additions left out, too");
  command->callback([&commands, given, paper] {
    if (given->what == "speed" && paper->count_all() > 1) {
      throw CLI::ValidationError("bench speed", "takes no option of paper's");
    }
    commands.action = [given](Program& program) -> Result<int> {
      Progress progress(program.options().json);
      ExecutionContext context(
          [&progress](const std::string& stage, double share) {
            progress.Report(stage, share);
          });
      const auto open = [&program](const std::string& db) {
        return program.MakeService(db, Store::OpenMode::kOpenOrCreate);
      };
      return given->what == "speed"
                 ? BenchSpeed(program, *given, open, context)
                 : BenchPaper(program, *given, open, context);
    };
  });
}

}  // namespace graspdb
