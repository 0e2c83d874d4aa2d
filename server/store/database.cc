#include "server/store/database.h"

#include <cctype>
#include <chrono>
#include <thread>

#include <sqlite3.h>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

constexpr int kMaxPolls = 10'000;  // Ten seconds of them.
constexpr int64_t kMaxIdleStatements = 128;

// SQLite's own handler soon sleeps for 100 ms, which finds no gap between the
// writes of a busy program.
int PollEachMillisecond(void*, int polls) {
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return polls < kMaxPolls ? 1 : 0;
}

// What a person can do about an SQLite error.
const char* FindHint(int code) {
  switch (code & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "another program holds the database; stop it or try again";
    case SQLITE_FULL:
      return "the disk is full; free some space, reading goes on meanwhile";
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_CANTOPEN:
      return "check that file and folder exist and are writable";
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return "restore a backup; graspdb check tells what is damaged";
    case SQLITE_IOERR:
      return "the disk failed; see the system's log";
    default:
      return "";
  }
}

int OpenFlags(Database::Mode mode) {
  constexpr int kCommon = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
  switch (mode) {
    case Database::Mode::kReadWriteCreate:
      return kCommon | SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
    case Database::Mode::kReadWrite:
      return kCommon | SQLITE_OPEN_READWRITE;
    case Database::Mode::kReadOnly:
      return kCommon | SQLITE_OPEN_READONLY;
    case Database::Mode::kImmutable:
      return kCommon | SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
  }
  return kCommon;
}

// The path as a file: URI, every unusual byte escaped.
std::string MakeImmutableUri(const std::string& path) {
  constexpr char kHex[] = "0123456789abcdef";
  std::string uri = "file:";
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || c == '/' || c == '.' || c == '-' || c == '_') {
      uri += c;
    } else {
      uri += {'%', kHex[byte >> 4], kHex[byte & 15]};
    }
  }
  return uri + "?immutable=1";
}

}  // namespace

Statement::Statement(Statement&& other) noexcept
    : database_(other.database_),
      sql_(std::move(other.sql_)),
      handle_(std::exchange(other.handle_, nullptr)),
      next_parameter_(other.next_parameter_) {}

Statement::~Statement() {
  if (handle_ == nullptr) return;
  sqlite3_reset(handle_);
  sqlite3_clear_bindings(handle_);
  if (std::ssize(database_->idle_) < kMaxIdleStatements) {
    database_->idle_.emplace(std::move(sql_), handle_);
  } else {
    sqlite3_finalize(handle_);
  }
}

void Statement::BindNext(int64_t value) {
  const int code = sqlite3_bind_int64(handle_, next_parameter_++, value);
  if (code != SQLITE_OK) database_->Fail(code);
}

void Statement::BindNext(double value) {
  const int code = sqlite3_bind_double(handle_, next_parameter_++, value);
  if (code != SQLITE_OK) database_->Fail(code);
}

void Statement::BindNext(const std::string& value) {
  const int code =
      sqlite3_bind_text64(handle_, next_parameter_++, value.data(),
                          value.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  if (code != SQLITE_OK) database_->Fail(code);
}

void Statement::BindNext(const std::optional<double>& value) {
  if (value) {
    BindNext(*value);
  } else {
    ++next_parameter_;  // Parameters start as NULL.
  }
}

void Statement::BindNext(const std::optional<int>& value) {
  if (value) {
    BindNext(*value);
  } else {
    ++next_parameter_;  // Parameters start as NULL.
  }
}

void Statement::BindNext(const std::optional<int64_t>& value) {
  if (value) {
    BindNext(*value);
  } else {
    ++next_parameter_;  // Parameters start as NULL.
  }
}

Statement& Statement::BindTextOrNull(const std::string& text) {
  if (text.empty()) {
    ++next_parameter_;
  } else {
    BindNext(text);
  }
  return *this;
}

Statement& Statement::BindBlob(std::string_view bytes) {
  const char* data = bytes.empty() ? "" : bytes.data();
  const int code = sqlite3_bind_blob64(handle_, next_parameter_++, data,
                                       bytes.size(), SQLITE_TRANSIENT);
  if (code != SQLITE_OK) database_->Fail(code);
  return *this;
}

bool Statement::Step() {
  const int code = sqlite3_step(handle_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) database_->Fail(code);
  return false;
}

void Statement::Run() {
  while (Step()) {
  }
}

int64_t Statement::Int(int column) const {
  return sqlite3_column_int64(handle_, column);
}

double Statement::Double(int column) const {
  return sqlite3_column_double(handle_, column);
}

std::string Statement::Text(int column) const {
  const unsigned char* text = sqlite3_column_text(handle_, column);
  if (text == nullptr) return {};
  return {reinterpret_cast<const char*>(text),
          static_cast<size_t>(sqlite3_column_bytes(handle_, column))};
}

std::string Statement::Blob(int column) const {
  const void* bytes = sqlite3_column_blob(handle_, column);
  if (bytes == nullptr) return {};
  return {static_cast<const char*>(bytes),
          static_cast<size_t>(sqlite3_column_bytes(handle_, column))};
}

bool Statement::IsNull(int column) const {
  return sqlite3_column_type(handle_, column) == SQLITE_NULL;
}

std::optional<double> Statement::OptionalDouble(int column) const {
  if (IsNull(column)) return std::nullopt;
  return Double(column);
}

Database::Database(const std::string& path, Mode mode) {
  const std::string name =
      mode == Mode::kImmutable ? MakeImmutableUri(path) : path;
  const int code =
      sqlite3_open_v2(name.c_str(), &handle_, OpenFlags(mode), nullptr);
  if (code != SQLITE_OK) {
    const Error error{
        ErrorCode::kStorage,
        "Cannot open the database " + path + ": " + sqlite3_errstr(code) + ".",
        FindHint(code)};
    sqlite3_close_v2(handle_);
    throw StorageFailure(error);
  }
  // Without the right to write SQLite opens for reading, silently.
  if (mode == Mode::kReadWrite && sqlite3_db_readonly(handle_, "main") == 1) {
    sqlite3_close_v2(handle_);
    throw StorageFailure(Error{ErrorCode::kStorage,
                               "The database " + path + " cannot be written.",
                               FindHint(SQLITE_READONLY)});
  }
  sqlite3_busy_handler(handle_, PollEachMillisecond, nullptr);
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_ENABLE_FKEY, 1, nullptr);
}

Database::~Database() {
  for (const auto& [sql, handle] : idle_) sqlite3_finalize(handle);
  sqlite3_close_v2(handle_);
}

void Database::Execute(const std::string& sql) {
  const int code =
      sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) Fail(code);
}

Statement Database::Prepare(const std::string& sql) {
  if (auto node = idle_.extract(sql); !node.empty()) {
    return {this, sql, node.mapped()};
  }
  sqlite3_stmt* handle = nullptr;
  const int code =
      sqlite3_prepare_v3(handle_, sql.data(), static_cast<int>(sql.size()),
                         SQLITE_PREPARE_PERSISTENT, &handle, nullptr);
  if (code != SQLITE_OK) Fail(code);
  return {this, sql, handle};
}

int64_t Database::QueryInt(const std::string& sql) {
  Statement statement = Prepare(sql);
  return statement.Step() ? statement.Int(0) : 0;
}

std::string Database::QueryText(const std::string& sql) {
  Statement statement = Prepare(sql);
  return statement.Step() ? statement.Text(0) : std::string();
}

int64_t Database::Changes() const { return sqlite3_changes64(handle_); }

int64_t Database::CalcMemory() { return sqlite3_memory_used(); }

bool Database::InTransaction() const {
  return sqlite3_get_autocommit(handle_) == 0;
}

void Database::Heed(const ExecutionContext& context) {
  constexpr int kInstructions = 20;  // A few rows, which may be large.
  // SQLite's own type has no const.
  void* const argument = const_cast<ExecutionContext*>(&context);
  sqlite3_progress_handler(
      handle_, kInstructions,
      [](void* heeded) {
        const auto* const seen = static_cast<const ExecutionContext*>(heeded);
        return seen->Cancelled() ? 1 : 0;
      },
      argument);
}

void Database::GiveWay() {
  constexpr std::chrono::milliseconds kLong(50);
  constexpr std::chrono::milliseconds kPause(3);  // A few polls.
  const auto now = Clock::now();
  if (now - last_write_ >= kPause) {
    last_pause_ = now;
  } else if (now - last_pause_ >= kLong) {
    std::this_thread::sleep_for(kPause);
    last_pause_ = Clock::now();
  }
}

void Database::Fail(int code) const {
  if ((code & 0xff) == SQLITE_INTERRUPT) {
    throw StorageFailure(Error{ErrorCode::kCancelled,
                               "The work on the database was cancelled."});
  }
  // What is checked before a write may be gone when it comes.
  if (code == SQLITE_CONSTRAINT_FOREIGNKEY) {
    throw StorageFailure(
        Error{ErrorCode::kConflict,
              "What this belongs to was deleted in the meantime.",
              "send the request again"});
  }
  throw StorageFailure(Error{
      ErrorCode::kStorage,
      std::string("The database failed: ") + sqlite3_errmsg(handle_) + ".",
      FindHint(code)});
}

Transaction::Transaction(Database& database, Kind kind)
    : database_(database), kind_(kind) {
  if (kind == Kind::kWrite) database_.GiveWay();
  database_.Execute(kind == Kind::kWrite ? "BEGIN IMMEDIATE" : "BEGIN");
}

Transaction::~Transaction() {
  if (kind_ == Kind::kWrite) database_.last_write_ = Database::Clock::now();
  if (!open_ || !database_.InTransaction()) return;
  try {
    database_.Execute("ROLLBACK");
  } catch (const StorageFailure&) {
    // The connection failed so hard that SQLite rolls back when it closes.
  }
}

void Transaction::Commit() {
  database_.Execute("COMMIT");
  open_ = false;
}

}  // namespace graspdb
