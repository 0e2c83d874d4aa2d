#include "server/cli/subcommands.h"

#include "server/cli/progress.h"
#include "server/cli/report.h"

namespace graspdb {

void AddLearn(Subcommands& commands) {
  CLI::App* command = commands.Add(
      "learn", "Learn the grasp spaces of a stored object.",
      "graspdb learn 0198f2c4-… --part handle", Source::kFileOrServer);
  commands.AddEngineOptions(command);
  const auto order = Share<LearnOrder>();
  const auto parameters = Share<std::string>();
  command->add_option("object", order->object_id, "object's id")->required();
  command->add_option("--part", order->part_labels, "parts (all)");
  command->add_option("--hand", order->hands, "hands (all)");
  command->add_option("--seed", order->seed, "")->capture_default_str();
  command->add_option("--parameters", *parameters,
                      "default, paper, JSON or a file of it");
  command->callback([&commands, order, parameters] {
    commands.action = [order, parameters](Program& program) -> Result<int> {
      GRASPDB_TRY(read, ReadParameters(*parameters));
      order->parameters = read;
      GRASPDB_TRY(backend, program.OpenBackend());
      Progress progress(program.options().json);
      GRASPDB_TRY(spaces, backend->Learn(*order, progress));
      return program.Print(spaces, ReportGraspSpaces);
    };
  });
}

}  // namespace graspdb
