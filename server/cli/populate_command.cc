#include "server/cli/subcommands.h"

#include "server/cli/progress.h"
#include "server/cli/report.h"
#include "server/codec/record_json.h"
#include "server/jobs/data_folder.h"

namespace graspdb {

void AddPopulate(Subcommands& commands) {
  CLI::App* command = commands.Add(
      "populate", "Bring a data folder into the database and learn from it.",
      "graspdb populate data --db graspdb.db", Source::kFile);
  commands.AddEngineOptions(command);
  const auto order = Share<PopulateOrder>();
  const auto parameters = Share<std::string>();
  const auto skip = std::make_shared<bool>(false);
  command->add_option("folder", order->folder, "such as data")->required();
  command->add_option("--hand", order->hands, "hands to learn with (all)");
  command->add_option("--seed", order->seed, "")->capture_default_str();
  command->add_option("--parameters", *parameters,
                      "default, paper, JSON or a file of it");
  command->add_flag("--no-learn", *skip, "import only");
  command->callback([&commands, order, parameters, skip] {
    commands.action = [order, parameters,
                       skip](Program& program) -> Result<int> {
      GRASPDB_TRY(read, ReadParameters(*parameters));
      order->parameters = read;
      order->learn = !*skip;
      GRASPDB_TRY(service, program.OpenService(Store::OpenMode::kOpenOrCreate));
      Progress progress(program.options().json);
      ExecutionContext context([&](const std::string& stage, double share) {
        progress.Report(stage, share);
      });
      GRASPDB_TRY(spaces, Populate(*service, *order, context));
      std::vector<std::string> items;
      for (const StoredGraspSpace& space : spaces) {
        items.push_back(ToJson(space));
      }
      return program.Print(ListToJson(items, ""), ReportGraspSpaces);
    };
  });
}

}  // namespace graspdb
