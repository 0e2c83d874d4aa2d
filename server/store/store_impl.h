#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/store/database.h"
#include "server/store/store.h"

/** @file
 What the .cc files of Store share. Functions that take a Database run inside
 the caller's transaction and throw StorageFailure. */

namespace graspdb {

/** One connection that writes, as many that read as there are readers. */
struct Store::Impl {
  std::string path;
  int schema_version{0};
  std::mutex write_mutex;
  std::unique_ptr<Database> writer;
  std::mutex readers_mutex;
  std::vector<std::unique_ptr<Database>> idle_readers;

  /** Runs `operation(Database&)` on one snapshot. */
  template <class F>
  auto Read(F&& operation) {
    return RunStorage([&] {
      const std::unique_ptr<Database, std::function<void(Database*)>> reader(
          TakeReader().release(),
          [this](Database* database) { GiveBack(database); });
      const Transaction transaction(*reader, Transaction::Kind::kRead);
      return operation(*reader);
    });
  }

  /** Runs `operation(Database&)` in one transaction and commits it. */
  template <class F>
  auto Write(F&& operation) {
    return RunStorage([&] {
      const std::lock_guard lock(write_mutex);
      Transaction transaction(*writer);
      if constexpr (std::is_void_v<decltype(operation(*writer))>) {
        operation(*writer);
        transaction.Commit();
      } else {
        auto result = operation(*writer);
        transaction.Commit();
        return result;
      }
    });
  }

 private:
  static constexpr size_t kMostIdleReaders = 16;

  std::unique_ptr<Database> TakeReader();
  void GiveBack(Database* database);
};

namespace store {

[[noreturn]] void Throw(ErrorCode code, const std::string& message,
                        const std::string& hint = "",
                        const std::string& field = "");

/** The value of a Result, or its error thrown. */
template <class T>
T Unwrap(Result<T> result) {
  if (!result) throw StorageFailure(result.error());
  return std::move(*result);
}

/** @throws kInvalidArgument unless the limit lies in 1..1000. */
void CheckPage(const PageRequest& page);
/** Whether the cursor may be one of a list by UUID, or by name.
 @throws StorageFailure kInvalidArgument when it is not. */
void CheckIdCursor(const PageRequest& page);
void CheckNameCursor(const PageRequest& page);
/** The row number that a list by rows goes on from; 0 for its first page.
 @throws StorageFailure kInvalidArgument when the cursor is none. */
int64_t ReadRowCursor(const PageRequest& page);

/** Cuts a list that was read with one item more than asked for.
 @param cursor_of  Gives the cursor that continues after an item. */
template <class T, class F>
Page<T> MakePage(std::vector<T> items, int limit, F&& cursor_of) {
  Page<T> page;
  if (std::ssize(items) > limit) {
    items.resize(static_cast<size_t>(limit));
    page.next_cursor = cursor_of(items.back());
  }
  page.items = std::move(items);
  return page;
}

/** One page of the rows of a table whose key is `name`.
 @param read  What has the name, as ReadCategory(). */
template <class F>
auto ListByName(Database& database, const std::string& table,
                const PageRequest& page, F&& read) {
  CheckPage(page);
  CheckNameCursor(page);
  std::vector<std::string> names;
  Statement rows = database.Prepare("SELECT name FROM " + table +
                                    " WHERE name > ? ORDER BY name LIMIT ?");
  rows.Bind(page.cursor, page.limit + 1);
  while (rows.Step()) names.push_back(rows.Text(0));
  std::vector<decltype(read(table))> items;
  for (const std::string& name : names) items.push_back(read(name));
  return MakePage(std::move(items), page.limit,
                  [](const auto& last) { return last.name; });
}

/** For a hint: which names a table has, the first twenty. */
std::string ListNames(Database& database, const std::string& table);
/** How many rows there are: `from_where` ends with a condition on ?. */
int64_t CountOf(Database& database, const std::string& from_where,
                const std::string& value);

StoredObject ReadObject(Database& database, const std::string& id);
/** Adds the parts of a stored object that has none.
 @throws kConflict when the labels are not those of the category as it is. */
void InsertParts(Database& database, const StoredObject& object,
                 const ObjectMeshes& labelled,
                 const std::vector<StoredPart>& parts,
                 const std::vector<Part>& solids);
std::vector<StoredPart> ReadParts(Database& database,
                                  const std::string& object_id);
/** Adds a parameter set, once. */
void InsertParameterSet(Database& database, const std::string& hash,
                        const std::string& json);
/** Adds a grasp of a stored grasp space. */
void InsertGrasp(Database& database, const StoredGrasp& grasp);

// What `graspdb check` looks at; each adds to the report.
void CheckObjects(Database& database, CheckReport& report);
void CheckGrasps(Database& database, CheckReport& report);

}  // namespace store
}  // namespace graspdb
