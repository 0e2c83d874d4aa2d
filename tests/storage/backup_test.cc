#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include <gmock/gmock.h>

#include "server/store/database.h"
#include "server/store/store.h"
#include "tests/support/rounds.h"
#include "tests/support/stored_records.h"
#include "tests/support/temp_folder.h"

namespace graspdb {
namespace {

using ::testing::IsEmpty;

namespace fs = std::filesystem;

// Every row of every table as text, sorted.
std::multiset<std::string> ReadRows(const std::string& path) {
  Database database(path, Database::Mode::kReadOnly);
  std::vector<std::string> tables;
  {
    Statement rows = database.Prepare(
        "SELECT name FROM sqlite_master WHERE type = 'table'"
        " AND name NOT LIKE 'sqlite_%'");
    while (rows.Step()) tables.push_back(rows.Text(0));
  }
  std::multiset<std::string> all;
  for (const std::string& table : tables) {
    std::string columns;
    Statement names = database.Prepare("SELECT name FROM pragma_table_info(?)");
    names.Bind(table);
    while (names.Step()) {
      columns += (columns.empty() ? "quote(" : " || ' ' || quote(") +
                 names.Text(0) + ")";
    }
    Statement rows = database.Prepare("SELECT " + columns + " FROM " + table);
    while (rows.Step()) all.insert(table + " " + rows.Text(0));
  }
  return all;
}

class BackupTest : public ::testing::Test {
 protected:
  BackupTest() {
    EXPECT_TRUE(store_->InsertCategory(MakeMugCategory()));
    EXPECT_TRUE(store_->InsertHand(MakeClaw()));
    EXPECT_TRUE(store_->InsertObject(MakeNewObject("e", ObjectRole::kExample)));
  }

  TempFolder folder_;
  std::unique_ptr<Store> store_ = Store::Open(folder_.File("a.db")).value();
};

TEST_F(BackupTest, HoldsTheSameRows) {
  const std::string copy = folder_.File("copy.db");
  ASSERT_TRUE(store_->WriteBackup(copy));
  const auto rows = ReadRows(folder_.File("a.db"));
  EXPECT_GT(rows.size(), 10u);
  EXPECT_EQ(ReadRows(copy), rows);
  const auto restored = Store::Open(copy, Store::OpenMode::kMustExist);
  ASSERT_TRUE(restored) << restored.error().message;
  EXPECT_THAT((*restored)->Check().value().problems, IsEmpty());
  EXPECT_EQ((*restored)->schema_version(), store_->schema_version());
}

TEST_F(BackupTest, UnderWritesHoldsAllThatWasAcknowledgedBefore) {
  std::atomic<int> acknowledged{0};
  std::jthread writer([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const auto written =
          store_->InsertJob(JobKind::kLearn, true, "{}", "payload", {});
      EXPECT_TRUE(written);
      ++acknowledged;
    }
  });
  for (int i = 0; i < CountRounds(10); ++i) {
    const int before = acknowledged;
    const std::string copy = folder_.File("copy" + std::to_string(i) + ".db");
    ASSERT_TRUE(store_->WriteBackup(copy));
    const int after = acknowledged + 1;  // One may be on its way.
    const auto restored = Store::Open(copy, Store::OpenMode::kMustExist);
    ASSERT_TRUE(restored) << restored.error().message;
    const auto jobs = (*restored)->Count().value().jobs_unfinished;
    EXPECT_GE(jobs, before);
    EXPECT_LE(jobs, after);
    EXPECT_THAT((*restored)->Check().value().problems, IsEmpty());
  }
  EXPECT_GT(acknowledged, 0);
  writer.request_stop();
  writer.join();
  // Nothing is changed here after it was written: each row is one of the last.
  const auto all = ReadRows(folder_.File("a.db"));
  for (int i = 0; i < CountRounds(10); ++i) {
    const auto rows =
        ReadRows(folder_.File("copy" + std::to_string(i) + ".db"));
    EXPECT_TRUE(
        std::includes(all.begin(), all.end(), rows.begin(), rows.end()));
  }
}

TEST_F(BackupTest, HoldsTensOfMegabytes) {
  const int pieces = std::min(100, CountRounds(20));
  for (int i = 0; i < pieces; ++i) {
    ASSERT_TRUE(store_->InsertJob(JobKind::kLearn, true, "{}",
                                  std::string(1'000'000, 'x'), {}));
  }
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_TRUE(store_->WriteBackup(folder_.File("copy.db")));
  const std::chrono::duration<double> seconds =
      std::chrono::steady_clock::now() - begin;
  EXPECT_GT(fs::file_size(folder_.File("copy.db")), 1'000'000u * pieces);
  RecordProperty("milliseconds_per_100_megabytes",
                 static_cast<int>(1e3 * seconds.count() * 100 / pieces));
}

TEST_F(BackupTest, ThatIsCancelledLeavesNothing) {
  const std::string copy = folder_.File("copy.db");
  ExecutionContext context;
  context.Cancel();
  EXPECT_EQ(store_->WriteBackup(copy, context).error().code,
            ErrorCode::kCancelled);
  EXPECT_FALSE(fs::exists(copy));
  EXPECT_FALSE(fs::exists(copy + ".partial"));
  EXPECT_TRUE(store_->WriteBackup(copy));
}

TEST_F(BackupTest, OverwritesNothing) {
  const std::string other = folder_.File("other.txt");
  std::ofstream(other) << "mine";
  EXPECT_EQ(store_->WriteBackup(other).error().code, ErrorCode::kConflict);
  std::string content;
  std::ifstream(other) >> content;
  EXPECT_EQ(content, "mine");
}

TEST_F(BackupTest, ThatCannotBeWrittenLeavesNothing) {
  const std::string path = folder_.File("no/such/folder/copy.db");
  const auto written = store_->WriteBackup(path);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kStorage);
  EXPECT_FALSE(fs::exists(folder_.File("no")));
}

TEST_F(BackupTest, ALeftoverOfACrashIsNoHindrance) {
  const std::string copy = folder_.File("copy.db");
  std::ofstream(copy + ".partial") << "half of it";
  ASSERT_TRUE(store_->WriteBackup(copy));
  EXPECT_FALSE(fs::exists(copy + ".partial"));
  EXPECT_EQ(ReadRows(copy), ReadRows(folder_.File("a.db")));
}

}  // namespace
}  // namespace graspdb
