#include "server/cli/subcommands.h"

#include "server/cli/progress.h"
#include "server/cli/report.h"

namespace graspdb {

void AddGrasp(Subcommands& commands) {
  CLI::App* command =
      commands.Add("grasp", "Find grasps for a mesh by transfer.",
                   "graspdb grasp mug.stl --category mug --units mm --count 10",
                   Source::kFileOrServer);
  commands.AddEngineOptions(command);
  const auto order = Share<TransferOrder>();
  struct Extra {
    std::string path, parameters, stage;
    std::optional<int> count;
    std::optional<double> friction, deadline;
  };
  const auto extra = Share<Extra>();
  AddMeshOptions(command, order->mesh, extra->path);
  command->add_option("--category", order->category, "category, or auto")
      ->required();
  command->add_option("--part", order->part_labels, "parts to grasp (all)");
  command->add_option("--task", order->task, "grasp parts that serve it");
  command->add_option("--hand", order->hand, "hand")->capture_default_str();
  command->add_option("--count", extra->count,
                      "most grasps, best first; stops at so many sure ones");
  command->add_flag("--exhaustive", order->exhaustive,
                    "try all sources though --count is given");
  command->add_option("--sources", order->sources, "source grasps per part")
      ->capture_default_str();
  command->add_option("--friction", extra->friction, "coefficient");
  command
      ->add_option("--deadline", extra->deadline,
                   "seconds after which what was found is the answer")
      ->check(CLI::Range(0.1, 86400.0));
  command->add_option("--stage", extra->stage, "assembly (default), transfer");
  command->add_option("--seed", order->seed, "")->capture_default_str();
  command->add_option("--parameters", extra->parameters,
                      "default, paper, JSON or a file of it");
  command->callback([&commands, order, extra] {
    commands.action = [order, extra](Program& program) -> Result<int> {
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
      GRASPDB_TRY(answer, backend->Grasp(*order, extra->deadline, progress));
      return program.Print(answer, ReportTransfer);
    };
  });
}

}  // namespace graspdb
