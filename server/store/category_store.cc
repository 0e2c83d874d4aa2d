#include <map>

#include "engine/parameters/parameters.h"
#include "server/ids.h"
#include "server/store/store.h"
#include "server/store/store_impl.h"

namespace graspdb {

using store::CountOf;
using store::ListByName;
using store::ListNames;
using store::Throw;
using store::Unwrap;

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
  const auto is_part = [&](int64_t index) {
    return index >= 0 && index < std::ssize(category.parts);
  };
  while (pairs.Step()) {
    const int64_t a = pairs.Int(0);
    const int64_t b = pairs.Int(1);
    // Older programs kept pairs of parts that were gone.
    if (is_part(a) && is_part(b)) category.adjacency.emplace_back(a, b);
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

}  // namespace

Result<AddedCategory> Store::InsertCategory(const StoredCategory& category) {
  return impl_->Write([&](Database& database) {
    if (CountOf(database, "categories WHERE name = ?", category.name) > 0) {
      const StoredCategory old = ReadCategory(database, category.name);
      StoredCategory same = category;
      same.created_at = old.created_at;
      if (same == old) return AddedCategory{old, false};
      Throw(ErrorCode::kConflict,
            "There is a category '" + category.name + "' already.",
            "PATCH /v1/categories/" + category.name + " changes it", "name");
    }
    database.Prepare("INSERT INTO categories VALUES (?, ?, ?)")
        .Bind(category.name, category.title, FormatNow())
        .Run();
    InsertCategoryLists(database, category);
    return AddedCategory{ReadCategory(database, category.name), true};
  });
}

Result<StoredCategory> Store::UpdateCategory(const std::string& name,
                                             const CategoryChange& change) {
  return impl_->Write([&](Database& database) {
    const StoredCategory old = ReadCategory(database, name);
    const StoredCategory category = Unwrap(change(old));
    GRASPDB_EXPECTS(category.name == name);
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

}  // namespace graspdb
