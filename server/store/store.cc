#include "server/store/store.h"

#include <algorithm>
#include <charconv>

#include "server/ids.h"
#include "server/store/blob_codec.h"
#include "server/store/migrator.h"
#include "server/store/store_impl.h"

namespace graspdb {
namespace store {

void Throw(ErrorCode code, const std::string& message, const std::string& hint,
           const std::string& field) {
  throw StorageFailure(Error{code, message, hint, field});
}

void CheckPage(const PageRequest& page) {
  if (page.limit < 1 || page.limit > 1000) {
    Throw(ErrorCode::kInvalidArgument, "limit must lie in 1..1000.",
          "leave it out for 100", "limit");
  }
}

namespace {

void CheckCursorLetters(const PageRequest& page, const char* letters) {
  if (page.cursor.find_first_not_of(letters) == std::string::npos) return;
  Throw(ErrorCode::kInvalidArgument, "The cursor is not of this list.",
        "use next_cursor of the page before", "cursor");
}

}  // namespace

void CheckIdCursor(const PageRequest& page) {
  CheckCursorLetters(page, "0123456789abcdef-");
}

void CheckNameCursor(const PageRequest& page) {
  CheckCursorLetters(page, "0123456789abcdefghijklmnopqrstuvwxyz_-");
}

int64_t ReadRowCursor(const PageRequest& page) {
  int64_t row = 0;
  const char* const end = page.cursor.data() + page.cursor.size();
  if (page.cursor.empty()) return row;
  const auto [stop, error] = std::from_chars(page.cursor.data(), end, row);
  if (error != std::errc() || stop != end) {
    Throw(ErrorCode::kInvalidArgument, "The cursor is not of this list.",
          "use next_cursor of the page before", "cursor");
  }
  return row;
}

void InsertParameterSet(Database& database, const std::string& hash,
                        const std::string& json) {
  database.Prepare("INSERT OR IGNORE INTO parameter_sets VALUES (?, ?)")
      .Bind(hash, json)
      .Run();
}

std::string ListNames(Database& database, const std::string& table) {
  std::string names;
  Statement rows =
      database.Prepare("SELECT name FROM " + table + " ORDER BY name LIMIT 20");
  while (rows.Step()) names += (names.empty() ? "" : ", ") + rows.Text(0);
  return names.empty() ? "none is stored yet" : "known: " + names;
}

int64_t CountOf(Database& database, const std::string& from_where,
                const std::string& value) {
  Statement row = database.Prepare("SELECT count(*) FROM " + from_where);
  return row.Bind(value).Step() ? row.Int(0) : 0;
}

}  // namespace store

using store::Throw;
using store::Unwrap;

std::unique_ptr<Database> Store::Impl::TakeReader() {
  {
    const std::lock_guard lock(readers_mutex);
    if (!idle_readers.empty()) {
      std::unique_ptr<Database> reader = std::move(idle_readers.back());
      idle_readers.pop_back();
      return reader;
    }
  }
  return std::make_unique<Database>(path, Database::Mode::kReadOnly);
}

void Store::Impl::GiveBack(Database* database) {
  std::unique_ptr<Database> reader(database);
  const std::lock_guard lock(readers_mutex);
  // The many that one burst needed take memory for ever.
  if (idle_readers.size() < kMostIdleReaders) {
    idle_readers.push_back(std::move(reader));
  }
}

Store::Store(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Store::~Store() = default;

const std::string& Store::path() const { return impl_->path; }
int Store::schema_version() const { return impl_->schema_version; }

Result<std::unique_ptr<Store>> Store::Open(const std::string& path,
                                           OpenMode mode) {
  GRASPDB_TRY(file, InspectDatabaseFile(path));
  if (file == DatabaseFile::kAbsent && mode == OpenMode::kMustExist) {
    return Error{ErrorCode::kStorage, path + " does not exist.",
                 "graspdb populate data --db " + path + " makes it"};
  }
  return RunStorage([&] {
    if (file == DatabaseFile::kAbsent) CreateDatabaseFile(path);
    auto impl = std::make_unique<Impl>();
    impl->path = path;
    impl->writer = std::make_unique<Database>(path, Database::Mode::kReadWrite);
    impl->writer->Execute(
        "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;"
        // What one large write has made of the log is given back.
        "PRAGMA journal_size_limit = 67108864;"
        // Indices are written all over: 32 MiB of their pages at hand.
        "PRAGMA cache_size = -32768;");
    ApplyMigrations(*impl->writer, Migrations());
    impl->schema_version =
        static_cast<int>(impl->writer->QueryInt("PRAGMA user_version"));
    return std::unique_ptr<Store>(new Store(std::move(impl)));
  });
}

// ---- Idempotency-Key --------------------------------------------------------

Result<std::optional<StoredReply>> Store::FindReply(
    const std::string& key) const {
  return impl_->Read([&](Database& database) {
    std::optional<StoredReply> reply;
    Statement row = database.Prepare(
        "SELECT request_sha256, status, headers, body FROM replies"
        " WHERE key = ?");
    if (!row.Bind(key).Step()) return reply;
    reply = StoredReply{
        key, row.Text(0), static_cast<int>(row.Int(1)), {}, row.Blob(3)};
    const std::string headers = row.Text(2);
    for (size_t begin = 0; begin < headers.size();) {
      const size_t end = headers.find('\n', begin);
      const std::string line = headers.substr(begin, end - begin);
      const size_t colon = line.find(": ");
      reply->headers.emplace_back(line.substr(0, colon),
                                  line.substr(colon + 2));
      begin = end + 1;
    }
    return reply;
  });
}

constexpr int64_t kReplyMilliseconds = 24 * 3600 * 1000;

Result<void> Store::InsertReply(const StoredReply& reply) {
  std::string headers;
  for (const auto& [name, value] : reply.headers) {
    GRASPDB_EXPECTS(name.find_first_of(":\r\n") == std::string::npos);
    GRASPDB_EXPECTS(value.find_first_of("\r\n") == std::string::npos);
    headers += name + ": " + value + "\n";
  }
  return impl_->Write([&](Database& database) {
    database.Prepare("DELETE FROM replies WHERE created_at < ?")
        .Bind(FormatTime(CalcUnixMilliseconds() - kReplyMilliseconds))
        .Run();
    database
        .Prepare(
            "INSERT OR IGNORE INTO replies (key, request_sha256, status,"
            " headers, created_at, body) VALUES (?, ?, ?, ?, ?, ?)")
        .Bind(reply.key, reply.request_sha256, reply.status, headers,
              FormatNow())
        .BindBlob(reply.body)
        .Run();
  });
}

// ---- Health -----------------------------------------------------------------

namespace {

StoreCounts CountRows(Database& database) {
  const auto count = [&](const std::string& from) {
    return database.QueryInt("SELECT count(*) FROM " + from);
  };
  StoreCounts counts;
  counts.categories = count("categories");
  counts.objects = count("objects");
  counts.parts = count("parts");
  counts.hands = count("hands");
  counts.grasp_spaces = count("grasp_spaces");
  counts.grasps = count("grasps INDEXED BY grasps_of_part");
  counts.transfers = count("transfers");
  counts.jobs_unfinished = count("jobs WHERE state IN ('queued', 'running')");
  return counts;
}

}  // namespace

Result<StoreCounts> Store::Count() const {
  return impl_->Read([](Database& database) { return CountRows(database); });
}

int64_t Store::CalcMemory() { return Database::CalcMemory(); }

Result<int64_t> Store::CalcSize() const {
  return impl_->Read([](Database& database) {
    return database.QueryInt("PRAGMA page_count") *
           database.QueryInt("PRAGMA page_size");
  });
}

Result<CheckReport> Store::Check() const {
  return impl_->Read([](Database& database) {
    CheckReport report;
    {
      Statement pages = database.Prepare("PRAGMA integrity_check");
      while (pages.Step()) {
        if (pages.Text(0) != "ok") report.problems.push_back(pages.Text(0));
      }
    }
    {
      Statement keys = database.Prepare("PRAGMA foreign_key_check");
      while (keys.Step()) {
        report.problems.push_back("A row of " + keys.Text(0) +
                                  " refers to a row of " + keys.Text(2) +
                                  " that is missing.");
      }
    }
    store::CheckObjects(database, report);
    store::CheckGrasps(database, report);
    report.counts = CountRows(database);
    return report;
  });
}

}  // namespace graspdb
