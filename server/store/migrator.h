#pragma once

#include <string>
#include <vector>

#include "engine/base/result.h"

namespace graspdb {

class Database;

/** One file of schema/migrations. */
struct Migration {
  int number{0};
  std::string sql;
};

/** All that this program knows, by number from 1; made from the .sql files when
 the program is built. */
const std::vector<Migration>& Migrations();

/** "GRDB", in every database of ours. */
inline constexpr int kApplicationId = 0x47524442;

enum class DatabaseFile { kAbsent, kOurs };

/** Looks at a file without writing to it or beside it.
 @retval kStorage for a file that is not an SQLite database, of another
   application, newer than this program or damaged; large files (over 64 MiB)
   are not searched for damage here, `graspdb check` does that. */
Result<DatabaseFile> InspectDatabaseFile(const std::string& path);

/** Creates a database at `path` in one step: either all of it is there or
 nothing. A file that appears there meanwhile is left alone.
 @throws StorageFailure. */
void CreateDatabaseFile(const std::string& path);

/** Applies what is missing, each migration in its own transaction.
 @throws StorageFailure. */
void ApplyMigrations(Database& database,
                     const std::vector<Migration>& migrations);

}  // namespace graspdb
