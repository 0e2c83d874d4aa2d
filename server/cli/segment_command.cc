#include "server/cli/subcommands.h"

#include "server/cli/progress.h"
#include "server/cli/report.h"

namespace graspdb {

void AddSegment(Subcommands& commands) {
  CLI::App* command =
      commands.Add("segment", "Store a mesh and cut it into its parts.",
                   "graspdb segment mug.stl --category mug --units mm",
                   Source::kFileOrServer);
  commands.AddEngineOptions(command);
  const auto order = Share<ImportOrder>();
  const auto path = Share<std::string>();
  AddMeshOptions(command, *order, *path);
  command->add_option("--category", order->category, "category, or auto")
      ->required();
  command->callback([&commands, order, path] {
    commands.action = [order, path](Program& program) -> Result<int> {
      GRASPDB_TRY_VOID(ReadMesh(*path, *order));
      GRASPDB_TRY(backend, program.OpenBackend());
      Progress progress(program.options().json);
      GRASPDB_TRY(object, backend->Segment(*order, progress));
      return program.Print(object, ReportObject);
    };
  });
}

}  // namespace graspdb
