#include <filesystem>

#include <fmt/format.h>

#include "server/cli/subcommands.h"
#include "server/codec/record_json.h"
#include "server/ids.h"

namespace graspdb {

void AddBackup(Subcommands& commands) {
  CLI::App* command = commands.Add(
      "backup", "Write a consistent copy of a database, also one in use.",
      "graspdb backup copy.db --db graspdb.db", Source::kFile);
  const auto path = Share<std::string>();
  command->add_option("file", *path, "the copy; must not exist")->required();
  command->callback([&commands, path] {
    commands.action = [path](Program& program) -> Result<int> {
      GRASPDB_TRY(store, Store::Open(program.options().db,
                                     Store::OpenMode::kMustExist));
      GRASPDB_TRY_VOID(store->WriteBackup(*path));
      StoredBackup backup;
      backup.name = *path;
      backup.created_at = FormatNow();
      GRASPDB_TRY(sha256, CalcFileSha256(*path));
      backup.sha256 = sha256;
      backup.bytes = static_cast<int64_t>(std::filesystem::file_size(*path));
      return program.Print(ToJson(backup), [&](const std::string&) {
        return fmt::format("{}: {} bytes, sha256 {}\n", backup.name,
                           backup.bytes, backup.sha256);
      });
    };
  });
}

}  // namespace graspdb
