#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"

struct sqlite3;
struct sqlite3_stmt;

namespace graspdb {

/** Carries an Error from the depth of a storage operation to RunStorage(), the
 edge where it becomes a Result. Never leaves server/store. */
class StorageFailure : public std::runtime_error {
 public:
  explicit StorageFailure(Error error)
      : std::runtime_error(error.message), error_(std::move(error)) {}
  const Error& error() const { return error_; }

 private:
  Error error_;
};

/** Runs an operation; a StorageFailure becomes its Error. */
template <class F>
auto RunStorage(F&& operation) -> Result<decltype(operation())> {
  try {
    if constexpr (std::is_void_v<decltype(operation())>) {
      operation();
      return {};
    } else {
      return operation();
    }
  } catch (const StorageFailure& failure) {
    return failure.error();
  }
}

class Database;

/** A prepared statement on loan from its Database's cache; given back, reset,
 when it goes out of scope. Parameters and columns count from 1 and 0, as in
 SQLite. Every function may throw StorageFailure. */
class Statement {
 public:
  ~Statement();
  Statement(Statement&& other) noexcept;
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;
  Statement& operator=(Statement&&) = delete;

  /** Binds the next parameters, in order. */
  template <class... Values>
  Statement& Bind(const Values&... values) {
    (BindNext(values), ...);
    return *this;
  }
  Statement& BindBlob(std::string_view bytes);
  /** Empty text becomes NULL. */
  Statement& BindTextOrNull(const std::string& text);

  /** @returns whether there is a row. */
  bool Step();
  /** Steps to the end. */
  void Run();

  // Columns of the current row; NULL reads as 0 or empty.
  int64_t Int(int column) const;
  double Double(int column) const;
  std::string Text(int column) const;
  std::string Blob(int column) const;
  bool IsNull(int column) const;
  std::optional<double> OptionalDouble(int column) const;

 private:
  friend class Database;
  Statement(Database* database, std::string sql, sqlite3_stmt* handle)
      : database_(database), sql_(std::move(sql)), handle_(handle) {}

  void BindNext(int64_t value);
  void BindNext(int value) { BindNext(int64_t{value}); }
  void BindNext(uint64_t value) { BindNext(static_cast<int64_t>(value)); }
  void BindNext(bool value) { BindNext(int64_t{value}); }
  void BindNext(double value);
  void BindNext(const std::string& value);
  void BindNext(const char* value) { BindNext(std::string(value)); }
  void BindNext(const std::optional<double>& value);
  void BindNext(const std::optional<int>& value);
  void BindNext(const std::optional<int64_t>& value);

  Database* database_;
  std::string sql_;
  sqlite3_stmt* handle_;
  int next_parameter_{1};
};

/** One connection to an SQLite file, for one thread at a time: foreign keys on,
 defensive, no trusted schema, waits for locks. Every function may throw
 StorageFailure. */
class Database {
 public:
  enum class Mode {
    kReadWriteCreate,
    kReadWrite,
    kReadOnly,
    kImmutable,  ///< Reads without locks; leaves no file beside the database.
  };

  Database(const std::string& path, Mode mode);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /** Runs one or more statements without results or parameters. */
  void Execute(const std::string& sql);
  /** @param sql  One statement; compiled once per connection. */
  Statement Prepare(const std::string& sql);
  /** The first column of the first row of a query. */
  int64_t QueryInt(const std::string& sql);
  std::string QueryText(const std::string& sql);
  /** How many rows the last statement changed. */
  int64_t Changes() const;
  bool InTransaction() const;
  /** What SQLite holds in memory for all databases of this process, bytes. */
  static int64_t CalcMemory();
  /** Statements end with kCancelled soon after the context is cancelled, which
   must outlive them. */
  void Heed(const ExecutionContext& context);

 private:
  friend class Statement;
  friend class Transaction;
  using Clock = std::chrono::steady_clock;
  [[noreturn]] void Fail(int code) const;
  /** Before a write: who has long written without a pause makes one, for
   others to find the database unlocked. */
  void GiveWay();

  sqlite3* handle_{nullptr};
  Clock::time_point last_pause_;
  Clock::time_point last_write_;
  std::multimap<std::string, sqlite3_stmt*> idle_;
};

/** All or nothing: rolled back at the end of its scope unless committed. */
class Transaction {
 public:
  enum class Kind { kRead, kWrite };
  explicit Transaction(Database& database, Kind kind = Kind::kWrite);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void Commit();

 private:
  Database& database_;
  Kind kind_;
  bool open_{true};
};

}  // namespace graspdb
