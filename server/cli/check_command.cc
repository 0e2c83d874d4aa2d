#include "server/cli/subcommands.h"

#include "server/cli/report.h"
#include "server/codec/record_json.h"

namespace graspdb {

void AddCheck(Subcommands& commands) {
  CLI::App* command =
      commands.Add("check", "Read the whole database and tell of any damage.",
                   "graspdb check --db graspdb.db", Source::kFile);
  command->callback([&commands] {
    commands.action = [](Program& program) -> Result<int> {
      GRASPDB_TRY(store, Store::Open(program.options().db,
                                     Store::OpenMode::kMustExist));
      GRASPDB_TRY(report, store->Check());
      const int printed = program.Print(ToJson(report), ReportCheck);
      return report.problems.empty() ? printed : kDamaged;
    };
  });
}

}  // namespace graspdb
