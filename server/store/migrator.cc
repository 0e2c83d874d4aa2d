#include "server/store/migrator.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <unistd.h>

#include "server/store/database.h"

namespace graspdb {
namespace {

namespace fs = std::filesystem;

constexpr uintmax_t kMaxBytesToSearch = 64 << 20;

Error Refuse(const std::string& path, const std::string& why,
             const std::string& hint) {
  return Error{ErrorCode::kStorage, path + " " + why + ".", hint};
}

// A big-endian number of the SQLite file header.
uint32_t ReadHeaderNumber(const std::array<char, 100>& header, size_t offset) {
  uint32_t number = 0;
  for (size_t i = 0; i < 4; ++i) {
    number = number << 8 | static_cast<unsigned char>(header[offset + i]);
  }
  return number;
}

// https://www.sqlite.org/fileformat2.html#the_database_header
Result<void> InspectHeader(const std::string& path) {
  std::array<char, 100> header{};
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return Refuse(path, "cannot be read", "check its permissions");
  }
  file.read(header.data(), header.size());
  const std::string magic(header.data(), 16);
  if (!file || magic != std::string("SQLite format 3\0", 16)) {
    return Refuse(path, "is not a database", "name another file with --db");
  }
  if (ReadHeaderNumber(header, 68) != kApplicationId) {
    return Refuse(path, "is the database of another program",
                  "name another file with --db");
  }
  const uint32_t version = ReadHeaderNumber(header, 60);
  if (version > Migrations().size()) {
    return Refuse(path,
                  "was written by a newer graspdb (schema " +
                      std::to_string(version) + ")",
                  "install that version");
  }
  return {};
}

// What the header cannot tell: a newer version still in the write-ahead log,
// and damage.
Result<void> InspectContent(const std::string& path, Database::Mode mode) {
  return RunStorage([&] {
    Database database(path, mode);
    const int64_t version = database.QueryInt("PRAGMA user_version");
    if (version > std::ssize(Migrations())) {
      throw StorageFailure(Refuse(path, "was written by a newer graspdb",
                                  "install that version"));
    }
    if (fs::file_size(path) <= kMaxBytesToSearch) {
      const std::string found = database.QueryText("PRAGMA integrity_check(1)");
      if (found != "ok") {
        throw StorageFailure(
            Refuse(path, "is damaged: " + found, "restore a backup of it"));
      }
    }
  });
}

// A file without a log is read as it lies there, with no file made beside it,
// unless another program writes into it meanwhile: then as it does.
Result<void> InspectContent(const std::string& path) {
  const auto has_log = [&] { return fs::exists(path + "-wal"); };
  if (has_log()) return InspectContent(path, Database::Mode::kReadOnly);
  const fs::file_time_type before = fs::last_write_time(path);
  auto inspected = InspectContent(path, Database::Mode::kImmutable);
  if (!inspected && (has_log() || fs::last_write_time(path) != before)) {
    inspected = InspectContent(path, Database::Mode::kReadOnly);
  }
  return inspected;
}

}  // namespace

Result<DatabaseFile> InspectDatabaseFile(const std::string& path) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (status.type() == fs::file_type::not_found) return DatabaseFile::kAbsent;
  if (status.type() == fs::file_type::directory) {
    return Refuse(path, "is a folder", "name a file in it with --db");
  }
  if (status.type() != fs::file_type::regular) {
    return Refuse(path, "is not a file", "name another with --db");
  }
  if (fs::file_size(path, code) == 0) return DatabaseFile::kAbsent;
  GRASPDB_TRY_VOID(InspectHeader(path));
  GRASPDB_TRY_VOID(InspectContent(path));
  return DatabaseFile::kOurs;
}

void CreateDatabaseFile(const std::string& path) {
  const std::string draft = path + ".new-" + std::to_string(getpid());
  std::error_code ignored;
  fs::remove(draft, ignored);
  try {
    {
      Database database(draft, Database::Mode::kReadWriteCreate);
      ApplyMigrations(database, Migrations());
    }
    // Another connection: one that has just dropped a table does not truncate
    // its log. From here on the header says so; a draft needs no log of its
    // own.
    Database database(draft, Database::Mode::kReadWrite);
    database.Execute("PRAGMA journal_mode = WAL");
    database.QueryText("PRAGMA wal_checkpoint(TRUNCATE)");
  } catch (const StorageFailure&) {
    fs::remove(draft, ignored);
    throw;
  }
  std::error_code code;
  if (fs::exists(path, ignored) && fs::file_size(path, ignored) == 0) {
    fs::rename(draft, path, code);
  } else {
    fs::create_hard_link(draft, path, code);  // Fails when the file exists.
    if (code == std::errc::file_exists) code.clear();
  }
  fs::remove(draft, ignored);
  if (code) {
    throw StorageFailure(Refuse(path, "cannot be created: " + code.message(),
                                "check that its folder is writable"));
  }
}

void ApplyMigrations(Database& database,
                     const std::vector<Migration>& migrations) {
  for (const Migration& migration : migrations) {
    Transaction transaction(database);
    if (database.QueryInt("PRAGMA user_version") < migration.number) {
      database.Execute(migration.sql);
      database.Execute("PRAGMA user_version = " +
                       std::to_string(migration.number));
    }
    transaction.Commit();
  }
}

}  // namespace graspdb
