#include "server/jobs/backup_folder.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "server/ids.h"
#include "tests/support/temp_folder.h"

namespace graspdb {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

namespace fs = std::filesystem;

TEST(BackupFolder, KeepsTheNewestAndTheirChecksums) {
  const TempFolder temp;
  const auto store = Store::Open(temp.File("a.db")).value();
  const std::string path = temp.File("a.db.backups");
  BackupFolder folder(path, 2);
  EXPECT_THAT(folder.List().value(), IsEmpty());
  std::vector<std::string> names;
  for (int i = 0; i < 3; ++i) {
    const StoredBackup made = folder.Add(*store).value();
    names.push_back(made.name);
    EXPECT_EQ(made.sha256, CalcFileSha256(path + "/" + made.name).value());
    EXPECT_EQ(made.bytes,
              static_cast<int64_t>(fs::file_size(path + "/" + made.name)));
  }
  const auto kept = folder.List().value();
  ASSERT_THAT(kept, SizeIs(2));
  EXPECT_EQ(kept[0].name, names[2]);
  EXPECT_EQ(kept[1].name, names[1]);
  EXPECT_EQ(kept[1].created_at.size(), 24u);
  EXPECT_EQ(std::distance(fs::directory_iterator(path), {}), 4);
}

TEST(BackupFolder, LeavesAloneWhatIsNotItsOwn) {
  const TempFolder temp;
  const auto store = Store::Open(temp.File("a.db")).value();
  const std::string path = temp.File("backups");
  fs::create_directory(path);
  for (const char* name :
       {"notes.txt", "graspdb-mine.db", "graspdb-20000101T000000.000Z.db"}) {
    std::ofstream(path + "/" + name) << "mine";  // Without a checksum.
  }
  BackupFolder folder(path, 1);
  ASSERT_TRUE(folder.Add(*store));
  ASSERT_TRUE(folder.Add(*store));
  EXPECT_THAT(folder.List().value(), SizeIs(1));
  EXPECT_TRUE(fs::exists(path + "/notes.txt"));
  EXPECT_TRUE(fs::exists(path + "/graspdb-mine.db"));
  EXPECT_TRUE(fs::exists(path + "/graspdb-20000101T000000.000Z.db"));
}

TEST(BackupFolder, RemovesWhatAKilledServerLeft) {
  const TempFolder temp;
  const auto store = Store::Open(temp.File("a.db")).value();
  const std::string path = temp.File("backups");
  fs::create_directory(path);
  const std::string old = path + "/graspdb-20200101T000000.000Z.db";
  for (const char* end : {".new", ".new.partial", ".sha256.new", ".sha256"}) {
    std::ofstream(old + end) << "half";
  }
  BackupFolder folder(path, 3);
  ASSERT_TRUE(folder.Add(*store));
  EXPECT_EQ(std::distance(fs::directory_iterator(path), {}), 2);
}

TEST(BackupFolder, AnswersAndKeepsTheOneItMadeThoughTheClockWasTurnedBack) {
  const TempFolder temp;
  const auto store = Store::Open(temp.File("a.db")).value();
  const std::string path = temp.File("backups");
  fs::create_directory(path);
  const std::string later = path + "/graspdb-29990101T000000.000Z.db";
  std::ofstream(later) << "later";
  std::ofstream(later + ".sha256") << "0123  later\n";
  BackupFolder folder(path, 1);
  const StoredBackup made = folder.Add(*store).value();
  EXPECT_TRUE(fs::exists(path + "/" + made.name));
  EXPECT_FALSE(fs::exists(later));
  EXPECT_EQ(made.name, folder.List().value().at(0).name);
  EXPECT_EQ(made.sha256, folder.List().value().at(0).sha256);
}

TEST(BackupFolder, ThatCannotBeMadeIsAnError) {
  const TempFolder temp;
  const auto store = Store::Open(temp.File("a.db")).value();
  std::ofstream(temp.File("file")) << "no folder";
  BackupFolder folder(temp.File("file/backups"), 1);
  EXPECT_EQ(folder.Add(*store).error().code, ErrorCode::kStorage);
}

}  // namespace
}  // namespace graspdb
