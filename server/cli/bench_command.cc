#include <fmt/format.h>

#include "server/bench/html_report.h"
#include "server/bench/paper_bench.h"
#include "server/cli/progress.h"
#include "server/cli/subcommands.h"

namespace graspdb {

void AddBench(Subcommands& commands) {
  CLI::App* command =
      commands.Add("bench", "Measure: the paper's tables and figures (paper).",
                   "graspdb bench paper --out bench", Source::kOwn);
  commands.AddEngineOptions(command);
  struct Given {
    PaperBenchOrder order;
    std::string what;
    std::vector<std::string> presets{"default"};
    bool no_physical{false};
    bool ablations{false};
  };
  const auto given = Share<Given>();
  PaperBenchOrder& order = given->order;
  command->add_option("what", given->what, "paper")
      ->required()
      ->check(CLI::IsMember({"paper"}));
  command->add_option("--data", order.data, "data folder")
      ->capture_default_str();
  command->add_option("--out", order.out, "folder for databases and reports")
      ->capture_default_str();
  command
      ->add_option("--preset", given->presets,
                   "default, paper or a file of JSON; several, separated by "
                   "commas, side by side")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--objects", order.objects,
                      "more meshes: a folder per category");
  command->add_option("--units", order.units, "of those meshes")
      ->capture_default_str();
  command->add_option("--category", order.categories, "categories")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--sources", order.sources, "source grasps per part")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--seed", order.seed, "")->capture_default_str();
  command->add_flag("--quick", order.quick,
                    "one novel object a category, eight grasps a part");
  command
      ->add_option(
          "--seeding-seconds", order.seeding_seconds,
          "for each way to seed the swarm and each part (10; none when "
          "quick)")
      ->check(CLI::Range(0.0, 3600.0));
  command->add_flag("--no-physical", given->no_physical, "no simulator");
  command->add_flag("--ablations", given->ablations,
                    "the default with each of its additions left out, too");
  command->callback([&commands, given] {
    commands.action = [given](Program& program) -> Result<int> {
      PaperBenchOrder& wanted = given->order;
      for (const std::string& preset : given->presets) {
        GRASPDB_TRY(parameters, ReadParameters(preset));
        wanted.variants.push_back({preset, parameters});
      }
      if (given->ablations) wanted.ablations = MakeAblations();
      wanted.physical = !given->no_physical;
      Progress progress(program.options().json);
      ExecutionContext context(
          [&progress](const std::string& stage, double share) {
            progress.Report(stage, share);
          });
      const auto open = [&program](const std::string& db) {
        return program.MakeService(db, Store::OpenMode::kOpenOrCreate);
      };
      GRASPDB_TRY(report, RunPaperBench(wanted, open, context));
      return program.Print(DumpJson(report), [&](const std::string&) {
        return MakeTextReport(report) +
               fmt::format("{0}/paper.html, {0}/paper.json\n", wanted.out);
      });
    };
  });
}

}  // namespace graspdb
