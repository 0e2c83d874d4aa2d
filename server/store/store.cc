#include "server/store/store.h"

#include <algorithm>
#include <charconv>

#include "engine/parameters/parameters.h"
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

}  // namespace store

using store::ListByName;
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
        // Indices are written all over: 32 MiB of their pages at hand.
        "PRAGMA cache_size = -32768;");
    ApplyMigrations(*impl->writer, Migrations());
    impl->schema_version =
        static_cast<int>(impl->writer->QueryInt("PRAGMA user_version"));
    return std::unique_ptr<Store>(new Store(std::move(impl)));
  });
}

// ---- Categories -------------------------------------------------------------

namespace {

// Segmentation settings ↔ (name, value) rows.
class SettingsWriter {
 public:
  SettingsWriter(Database& database, const std::string& category)
      : database_(database), category_(category) {}
  template <class T>
  void operator()(const char* name, const T& value, const ParameterInfo&) {
    database_.Prepare("INSERT INTO category_settings VALUES (?, ?, ?)")
        .Bind(category_, name, static_cast<double>(value))
        .Run();
  }

 private:
  Database& database_;
  const std::string& category_;
};

class SettingsReader {
 public:
  explicit SettingsReader(const std::map<std::string, double>& values)
      : values_(values) {}
  template <class T>
  void operator()(const char* name, T& value, const ParameterInfo&) {
    const auto found = values_.find(name);
    if (found != values_.end()) value = static_cast<T>(found->second);
  }
  void operator()(const char* name, bool& value, const ParameterInfo&) {
    const auto found = values_.find(name);
    if (found != values_.end()) value = found->second != 0.0;
  }

 private:
  const std::map<std::string, double>& values_;
};

std::string ListNames(Database& database, const std::string& table) {
  std::string names;
  Statement rows =
      database.Prepare("SELECT name FROM " + table + " ORDER BY name LIMIT 20");
  while (rows.Step()) names += (names.empty() ? "" : ", ") + rows.Text(0);
  return names.empty() ? "none is stored yet" : "known: " + names;
}

void ReadCategoryLists(Database& database, StoredCategory& category) {
  Statement parts = database.Prepare(
      "SELECT label FROM category_parts WHERE category = ?"
      " ORDER BY label_index");
  parts.Bind(category.name);
  while (parts.Step()) category.parts.push_back({parts.Text(0), {}, {}});
  for (CategoryPart& part : category.parts) {
    Statement tasks = database.Prepare(
        "SELECT task, note FROM category_tasks"
        " WHERE category = ? AND label = ?");
    tasks.Bind(category.name, part.label);
    while (tasks.Step()) part.tasks[tasks.Text(0)] = tasks.Text(1);
    Statement free = database.Prepare(
        "SELECT task, note FROM category_keep_free"
        " WHERE category = ? AND label = ?");
    free.Bind(category.name, part.label);
    while (free.Step()) part.keep_free[free.Text(0)] = free.Text(1);
  }
  Statement pairs = database.Prepare(
      "SELECT a, b FROM category_adjacency WHERE category = ?"
      " ORDER BY position");
  pairs.Bind(category.name);
  while (pairs.Step()) {
    category.adjacency.emplace_back(pairs.Int(0), pairs.Int(1));
  }
  std::map<std::string, double> values;
  Statement settings = database.Prepare(
      "SELECT name, value FROM category_settings WHERE category = ?");
  settings.Bind(category.name);
  while (settings.Step()) values[settings.Text(0)] = settings.Double(1);
  SettingsReader reader(values);
  SegmentationParameters::Visit(category.segmentation, reader);
}

StoredCategory ReadCategory(Database& database, const std::string& name) {
  StoredCategory category;
  {
    Statement row = database.Prepare(
        "SELECT name, title, created_at FROM categories WHERE name = ?");
    if (!row.Bind(name).Step()) {
      Throw(ErrorCode::kNotFound, "There is no category '" + name + "'.",
            ListNames(database, "categories"), "category");
    }
    category.name = row.Text(0);
    category.title = row.Text(1);
    category.created_at = row.Text(2);
  }
  ReadCategoryLists(database, category);
  return category;
}

void InsertCategoryLists(Database& database, const StoredCategory& category) {
  for (size_t i = 0; i < category.parts.size(); ++i) {
    const CategoryPart& part = category.parts[i];
    database.Prepare("INSERT INTO category_parts VALUES (?, ?, ?)")
        .Bind(category.name, static_cast<int64_t>(i), part.label)
        .Run();
    for (const auto& [task, note] : part.tasks) {
      database.Prepare("INSERT INTO category_tasks VALUES (?, ?, ?, ?)")
          .Bind(category.name, part.label, task, note)
          .Run();
    }
    for (const auto& [task, why] : part.keep_free) {
      database.Prepare("INSERT INTO category_keep_free VALUES (?, ?, ?, ?)")
          .Bind(category.name, part.label, task, why)
          .Run();
    }
  }
  for (size_t i = 0; i < category.adjacency.size(); ++i) {
    database.Prepare("INSERT INTO category_adjacency VALUES (?, ?, ?, ?)")
        .Bind(category.name, static_cast<int64_t>(i),
              category.adjacency[i].first, category.adjacency[i].second)
        .Run();
  }
  SettingsWriter writer(database, category.name);
  SegmentationParameters::Visit(category.segmentation, writer);
}

void DeleteCategoryLists(Database& database, const std::string& name) {
  for (const char* table :
       {"category_adjacency", "category_settings", "category_parts"}) {
    database
        .Prepare(std::string("DELETE FROM ") + table + " WHERE category = ?")
        .Bind(name)
        .Run();
  }
}

int64_t CountOf(Database& database, const std::string& from_where,
                const std::string& value) {
  Statement row = database.Prepare("SELECT count(*) FROM " + from_where);
  return row.Bind(value).Step() ? row.Int(0) : 0;
}

}  // namespace

Result<StoredCategory> Store::InsertCategory(const StoredCategory& category) {
  return impl_->Write([&](Database& database) {
    if (CountOf(database, "categories WHERE name = ?", category.name) > 0) {
      Throw(ErrorCode::kConflict,
            "There is a category '" + category.name + "' already.",
            "PATCH /v1/categories/" + category.name + " changes it", "name");
    }
    database.Prepare("INSERT INTO categories VALUES (?, ?, ?)")
        .Bind(category.name, category.title, FormatNow())
        .Run();
    InsertCategoryLists(database, category);
    return ReadCategory(database, category.name);
  });
}

Result<StoredCategory> Store::UpdateCategory(const StoredCategory& category) {
  return impl_->Write([&](Database& database) {
    const StoredCategory old = ReadCategory(database, category.name);
    const bool same_labels =
        MakeVocabulary(old).labels == MakeVocabulary(category).labels;
    if (!same_labels &&
        CountOf(database, "objects WHERE category = ?", category.name) > 0) {
      Throw(ErrorCode::kConflict,
            "The part labels of category '" + category.name +
                "' cannot change while objects have such parts.",
            "delete its objects first, or add another category", "parts");
    }
    DeleteCategoryLists(database, category.name);
    database.Prepare("UPDATE categories SET title = ? WHERE name = ?")
        .Bind(category.title, category.name)
        .Run();
    InsertCategoryLists(database, category);
    return ReadCategory(database, category.name);
  });
}

Result<StoredCategory> Store::FindCategory(const std::string& name) const {
  return impl_->Read(
      [&](Database& database) { return ReadCategory(database, name); });
}

Result<Page<StoredCategory>> Store::ListCategories(
    const PageRequest& page) const {
  return impl_->Read([&](Database& database) {
    return ListByName(
        database, "categories", page,
        [&](const std::string& name) { return ReadCategory(database, name); });
  });
}

Result<void> Store::DeleteCategory(const std::string& name, bool cascade) {
  return impl_->Write([&](Database& database) {
    ReadCategory(database, name);
    const int64_t objects =
        CountOf(database, "objects WHERE category = ?", name);
    const int64_t transfers =
        CountOf(database, "transfers WHERE category = ?", name);
    if (objects + transfers > 0 && !cascade) {
      Throw(ErrorCode::kConflict,
            "Category '" + name + "' has " + std::to_string(objects) +
                " objects and " + std::to_string(transfers) + " transfers.",
            "DELETE /v1/categories/" + name +
                "?cascade=true deletes them and their grasps too");
    }
    for (const char* table : {"transfers", "grasp_spaces", "objects"}) {
      database
          .Prepare(std::string("DELETE FROM ") + table + " WHERE category = ?")
          .Bind(name)
          .Run();
    }
    database.Prepare("DELETE FROM categories WHERE name = ?").Bind(name).Run();
  });
}

// ---- Hands ------------------------------------------------------------------

namespace {

StoredHand ReadHand(Database& database, const std::string& name,
                    bool with_meshes) {
  StoredHand hand;
  {
    Statement row = database.Prepare(
        "SELECT name, title, sha256, urdf, annotations, created_at"
        " FROM hands WHERE name = ?");
    if (!row.Bind(name).Step()) {
      Throw(ErrorCode::kNotFound, "There is no hand '" + name + "'.",
            ListNames(database, "hands"), "hand");
    }
    hand.name = row.Text(0);
    hand.title = row.Text(1);
    hand.sha256 = row.Text(2);
    hand.urdf = row.Text(3);
    hand.annotations = row.Text(4);
    hand.created_at = row.Text(5);
  }
  if (!with_meshes) return hand;
  Statement meshes = database.Prepare(
      "SELECT file, mesh FROM hand_meshes WHERE hand = ? ORDER BY position");
  meshes.Bind(name);
  while (meshes.Step()) {
    hand.meshes.emplace_back(meshes.Text(0),
                             Unwrap(DecodeMesh(meshes.Blob(1))));
  }
  return hand;
}

}  // namespace

Result<StoredHand> Store::InsertHand(const StoredHand& hand) {
  return impl_->Write([&](Database& database) {
    if (CountOf(database, "hands WHERE name = ?", hand.name) > 0) {
      const StoredHand old = ReadHand(database, hand.name, true);
      if (old.sha256 == hand.sha256) return old;
      Throw(ErrorCode::kConflict,
            "There is another hand '" + hand.name + "' already.",
            "give this one another name", "name");
    }
    database.Prepare("INSERT INTO hands VALUES (?, ?, ?, ?, ?, ?)")
        .Bind(hand.name, hand.title, hand.sha256, hand.urdf, hand.annotations,
              FormatNow())
        .Run();
    for (size_t i = 0; i < hand.meshes.size(); ++i) {
      database.Prepare("INSERT INTO hand_meshes VALUES (?, ?, ?, ?)")
          .Bind(hand.name, static_cast<int64_t>(i), hand.meshes[i].first)
          .BindBlob(EncodeMesh(hand.meshes[i].second))
          .Run();
    }
    return ReadHand(database, hand.name, true);
  });
}

Result<StoredHand> Store::FindHand(const std::string& name) const {
  return impl_->Read(
      [&](Database& database) { return ReadHand(database, name, true); });
}

Result<Page<StoredHand>> Store::ListHands(const PageRequest& page) const {
  return impl_->Read([&](Database& database) {
    return ListByName(database, "hands", page, [&](const std::string& name) {
      return ReadHand(database, name, false);
    });
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

Result<void> Store::InsertReply(const StoredReply& reply) {
  std::string headers;
  for (const auto& [name, value] : reply.headers) {
    GRASPDB_EXPECTS(name.find_first_of(":\r\n") == std::string::npos);
    GRASPDB_EXPECTS(value.find_first_of("\r\n") == std::string::npos);
    headers += name + ": " + value + "\n";
  }
  return impl_->Write([&](Database& database) {
    database.Execute(
        "DELETE FROM replies WHERE julianday(created_at) <"
        " julianday('now') - 1");
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
