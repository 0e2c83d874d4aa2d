#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

#include "server/store/database.h"
#include "server/store/migrator.h"
#include "server/store/store.h"
#include "tests/support/stored_records.h"
#include "tests/support/temp_folder.h"

namespace graspdb {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

namespace fs = std::filesystem;

std::string ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

void WriteFile(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// A database with a row in every table that matters, closed.
std::string MakeDatabase(const std::string& path) {
  auto store = std::move(*Store::Open(path));
  EXPECT_TRUE(store->InsertCategory(MakeMugCategory()));
  EXPECT_TRUE(store->InsertHand(MakeClaw()));
  const auto example =
      store->InsertObject(MakeNewObject("e", ObjectRole::kExample)).value();
  const auto novel =
      store->InsertObject(MakeNewObject("n", ObjectRole::kNovel)).value();
  const auto parts = store->ListParts(example.id).value();
  const auto space = store
                         ->InsertGraspSpace(MakeSpaceRecord(parts[1], 5),
                                            MakeGraspSpace(5, 40))
                         .value();
  const auto grasps = store->QueryGrasps({}).value().items;
  const NewTransfer transfer =
      MakeNewTransfer(space, grasps, store->ListParts(novel.id).value()[1]);
  EXPECT_TRUE(store->InsertTransfer(transfer.record, transfer.grasps));
  EXPECT_TRUE(store->InsertJob(JobKind::kLearn, true, "{}", "", {}));
  store.reset();
  return ReadFile(path);
}

// Whatever a server might read, to be survived.
void ReadEverything(const Store& store) {
  (void)store.Check();
  (void)store.Count();
  (void)store.ListCategories({});
  (void)store.ListHands({});
  (void)store.FindHand("claw");
  (void)store.ListJobs(std::nullopt, {});
  const auto objects = store.ListObjects({}, {});
  if (objects) {
    for (const StoredObject& object : objects->items) {
      (void)store.ReadObjectMeshes(object.id);
      const auto parts = store.ListParts(object.id);
      if (parts) (void)store.ReadSolids(*parts);
    }
  }
  const auto spaces = store.ListGraspSpaces({}, {});
  if (spaces) {
    for (const StoredGraspSpace& space : spaces->items) {
      (void)store.ReadGraspSpace(space.id);
    }
  }
  const auto grasps = store.QueryGrasps({});
  if (grasps) {
    for (const StoredGrasp& grasp : grasps->items) {
      if (!grasp.transfer_id.empty()) {
        (void)store.FindTransfer(grasp.transfer_id);
      }
    }
  }
}

TEST(DatabaseFile, IsOursAndSaysSo) {
  const TempFolder folder;
  const std::string bytes = MakeDatabase(folder.File("a.db"));
  EXPECT_EQ(bytes.substr(0, 15), "SQLite format 3");
  EXPECT_EQ(bytes.substr(68, 4), "GRDB");
  Database database(folder.File("a.db"), Database::Mode::kReadOnly);
  EXPECT_EQ(database.QueryInt("PRAGMA user_version"), std::ssize(Migrations()));
  EXPECT_EQ(database.QueryText("PRAGMA journal_mode"), "wal");
  EXPECT_EQ(database.QueryInt("PRAGMA foreign_keys"), 1);
  EXPECT_EQ(database.QueryInt("PRAGMA trusted_schema"), 0);
}

TEST(DatabaseFile, EveryTableIsStrictAndEveryForeignKeyIndexed) {
  const TempFolder folder;
  MakeDatabase(folder.File("a.db"));
  Database database(folder.File("a.db"), Database::Mode::kReadOnly);
  EXPECT_EQ(database.QueryInt(
                "SELECT count(*) FROM pragma_table_list WHERE schema = 'main'"
                " AND type = 'table' AND name NOT LIKE 'sqlite_%'"
                " AND strict = 0"),
            0);
  // A foreign key whose first column starts no index.
  EXPECT_EQ(
      database.QueryText(
          "SELECT group_concat(m.name || '.' || f.\"from\") FROM sqlite_master"
          " m JOIN pragma_foreign_key_list(m.name) f WHERE m.type = 'table'"
          " AND f.seq = 0 AND NOT EXISTS (SELECT 1 FROM"
          " pragma_index_list(m.name) i JOIN pragma_index_info(i.name) c"
          " ON c.seqno = 0 WHERE c.name = f.\"from\")"),
      "");
}

TEST(DatabaseFile, EveryListOfGraspsRunsAlongAnIndexThatHoldsItsFilters) {
  const TempFolder folder;
  MakeDatabase(folder.File("a.db"));
  Database database(folder.File("a.db"), Database::Mode::kReadOnly);
  const std::string epsilon = " ORDER BY g.epsilon DESC, g.seq DESC LIMIT 10";
  for (const std::string& query :
       {" WHERE g.category = 'a' AND g.stage = 'b'" + epsilon,
        " WHERE g.category = 'a' AND g.part_label = 'b' AND g.stage = 'b'" +
            epsilon,
        " WHERE g.category = 'a' AND g.part_label = 'b' AND g.hand = 'c'"
        " AND g.stage = 'd' AND g.epsilon >= 0.1" +
            epsilon,
        " WHERE g.hand = 'c'" + epsilon, " WHERE g.object_id = 'd'" + epsilon,
        " WHERE g.epsilon >= 0.5" + epsilon, epsilon,
        " WHERE g.category = 'a' AND (g.epsilon, g.seq) < (0.5, 7)" + epsilon,
        std::string(" WHERE g.category = 'a' ORDER BY g.hybrid ASC, g.seq ASC"
                    " LIMIT 10"),
        std::string(" WHERE g.category = 'a' ORDER BY ifnull(g.robust, -1.0)"
                    " DESC, g.seq DESC LIMIT 10"),
        std::string(" WHERE g.category = 'a' ORDER BY g.merit DESC, g.seq DESC"
                    " LIMIT 10")}) {
    Statement plan = database.Prepare(
        "EXPLAIN QUERY PLAN SELECT g.seq FROM grasps g" + query);
    std::string text;
    while (plan.Step()) text += plan.Text(3) + "\n";
    // SQLite 3.40 never calls an index on an expression covering.
    const bool robust = query.find("ifnull") != std::string::npos;
    const bool merit = query.find("merit") != std::string::npos;
    EXPECT_THAT(text, HasSubstr(robust  ? "INDEX grasps_by_robust"
                                : merit ? "INDEX grasps_by_merit"
                                        : "COVERING INDEX grasps_by_"))
        << query;
    EXPECT_THAT(text, ::testing::Not(HasSubstr("TEMP B-TREE"))) << query;
  }
}

TEST(DatabaseFile, AMissingFileIsOnlyMadeWhenAsked) {
  const TempFolder folder;
  const std::string path = folder.File("a.db");
  const auto missing = Store::Open(path, Store::OpenMode::kMustExist);
  ASSERT_FALSE(missing);
  EXPECT_FALSE(fs::exists(path));
  EXPECT_FALSE(Store::Open(folder.File("no/such/folder.db")));
  WriteFile(path, "");
  EXPECT_TRUE(Store::Open(path));
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    EXPECT_THAT(entry.path().string(), ::testing::Not(HasSubstr(".new-")));
  }
}

TEST(DatabaseFile, AForeignFileIsRefusedUnchanged) {
  const TempFolder folder;
  const std::string path = folder.File("a.db");
  std::vector<std::string> contents{
      "hello", std::string(5000, '\0'), "SQLite format 3\0 and no more",
      std::string("SQLite format 3\0", 16) + std::string(4080, 'x')};
  {
    Database foreign(folder.File("foreign.db"),
                     Database::Mode::kReadWriteCreate);
    foreign.Execute("PRAGMA application_id = 7; CREATE TABLE t (x)");
  }
  contents.push_back(ReadFile(folder.File("foreign.db")));
  for (const std::string& bytes : contents) {
    WriteFile(path, bytes);
    const auto opened = Store::Open(path);
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().code, ErrorCode::kStorage);
    EXPECT_EQ(opened.error().message.find('\n'), std::string::npos);
    EXPECT_FALSE(opened.error().hint.empty());
    EXPECT_EQ(ReadFile(path), bytes);
    EXPECT_FALSE(fs::exists(path + "-wal"));
    EXPECT_FALSE(fs::exists(path + "-journal"));
  }
  const auto directory = Store::Open(folder.path());
  ASSERT_FALSE(directory);
  EXPECT_THAT(directory.error().message, HasSubstr("is a folder"));
}

TEST(DatabaseFile, ANewerFileIsRefusedUnchanged) {
  const TempFolder folder;
  const std::string path = folder.File("a.db");
  MakeDatabase(path);
  {
    Database database(path, Database::Mode::kReadWrite);
    database.Execute("PRAGMA user_version = 999");
  }
  const std::string bytes = ReadFile(path);
  const auto opened = Store::Open(path);
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().message, HasSubstr("newer graspdb"));
  EXPECT_EQ(ReadFile(path), bytes);
}

// A newer version may so far be only in the write-ahead log of a process that
// was killed.
TEST(DatabaseFile, ANewerVersionInTheLogIsSeen) {
  const TempFolder folder;
  const std::string path = folder.File("a.db");
  MakeDatabase(path);
  Database newer(path, Database::Mode::kReadWrite);
  newer.Execute("PRAGMA user_version = 999");
  fs::copy(path, folder.File("b.db"));
  fs::copy(path + "-wal", folder.File("b.db-wal"));
  const auto opened = Store::Open(folder.File("b.db"));
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().message, HasSubstr("newer graspdb"));
}

TEST(DatabaseFile, ABitFlippedAnywhereNeverCrashesAndNeverWrites) {
  const TempFolder folder;
  const std::string sound = MakeDatabase(folder.File("sound.db"));
  const std::string path = folder.File("flipped.db");
  Random random(1);
  int refused = 0;
  for (int round = 0; round < 200; ++round) {
    // Half of them in the header and the schema, where they hurt most.
    const int range = round % 2 == 0 ? 8192 : static_cast<int>(sound.size());
    std::string bytes = sound;
    const auto at = static_cast<size_t>(random.NextIndex(range));
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.NextIndex(8)));
    WriteFile(path, bytes);
    {
      const auto store = Store::Open(path);
      if (store) {
        ReadEverything(**store);
      } else {
        ++refused;
        EXPECT_EQ(store.error().code, ErrorCode::kStorage);
        EXPECT_FALSE(fs::exists(path + "-wal")) << "byte " << at;
      }
    }
    EXPECT_EQ(ReadFile(path), bytes) << "byte " << at;
    for (const char* suffix : {"", "-wal", "-shm"}) fs::remove(path + suffix);
  }
  EXPECT_GT(refused, 0);
}

TEST(DatabaseFile, ATruncatedFileIsRefusedUnchanged) {
  const TempFolder folder;
  const std::string sound = MakeDatabase(folder.File("sound.db"));
  const std::string path = folder.File("cut.db");
  for (size_t size = 1; size < sound.size(); size += 3001) {
    const std::string bytes = sound.substr(0, size);
    WriteFile(path, bytes);
    EXPECT_FALSE(Store::Open(path)) << size;
    EXPECT_EQ(ReadFile(path), bytes);
  }
}

TEST(DatabaseFile, CheckFindsAFlippedBitInEveryKindOfBlob) {
  const TempFolder folder;
  const std::string path = folder.File("a.db");
  for (const char* sql :
       {"UPDATE object_data SET bytes = x'00'",
        "UPDATE object_data SET canonical_mesh = CAST("
        " substr(canonical_mesh, 1, length(canonical_mesh) - 1) || x'77'"
        " AS BLOB)",
        "UPDATE parts SET solid = x'0104'",
        "UPDATE grasps SET data = zeroblob(100)",
        "UPDATE grasp_spaces SET support_vectors = x''",
        "UPDATE contact_maps SET pose = x'01'",
        "UPDATE hand_meshes SET mesh = x'0101'",
        "DELETE FROM grasps WHERE seq = 1"}) {
    for (const char* suffix : {"", "-wal", "-shm"}) fs::remove(path + suffix);
    MakeDatabase(path);
    EXPECT_THAT(Store::Open(path).value()->Check().value().problems, IsEmpty());
    {
      Database database(path, Database::Mode::kReadWrite);
      database.Execute(sql);
    }
    const auto store = Store::Open(path);
    ASSERT_TRUE(store);
    EXPECT_THAT((*store)->Check().value().problems, ::testing::Not(IsEmpty()))
        << sql;
  }
}

TEST(Migrations, AnOlderDatabaseIsBroughtUpToDate) {
  const TempFolder folder;
  Database database(folder.File("a.db"), Database::Mode::kReadWriteCreate);
  const std::vector<Migration> first{{1, "CREATE TABLE a (x) STRICT;"}};
  std::vector<Migration> both = {{1, "CREATE TABLE a (x INTEGER) STRICT;"},
                                 {2, "ALTER TABLE a ADD COLUMN y TEXT;"}};
  ApplyMigrations(database, {both[0]});
  database.Execute("INSERT INTO a VALUES (7)");
  ApplyMigrations(database, both);
  ApplyMigrations(database, both);
  EXPECT_EQ(database.QueryInt("PRAGMA user_version"), 2);
  EXPECT_EQ(database.QueryInt("SELECT x FROM a WHERE y IS NULL"), 7);
}

TEST(Migrations, OneThatFailsLeavesNothingBehind) {
  const TempFolder folder;
  Database database(folder.File("a.db"), Database::Mode::kReadWriteCreate);
  const std::vector<Migration> bad = {
      {1, "CREATE TABLE a (x INTEGER) STRICT;"},
      {2, "CREATE TABLE b (y INTEGER) STRICT; CREATE TABLE a (z);"}};
  EXPECT_THROW(ApplyMigrations(database, bad), StorageFailure);
  EXPECT_EQ(database.QueryInt("PRAGMA user_version"), 1);
  EXPECT_EQ(
      database.QueryInt("SELECT count(*) FROM sqlite_master WHERE name = 'b'"),
      0);
}

TEST(Migrations, AreNumberedFromOneWithoutGaps) {
  int expected = 1;
  for (const Migration& migration : Migrations()) {
    EXPECT_EQ(migration.number, expected++);
    EXPECT_THAT(migration.sql, AnyOf(HasSubstr("CREATE"), HasSubstr("ALTER")));
  }
}

TEST(Store, TwoProcessesShareAFile) {
  const TempFolder folder;
  const auto one = Store::Open(folder.File("a.db"));
  const auto two = Store::Open(folder.File("a.db"));
  ASSERT_TRUE(one && two);
  EXPECT_TRUE((*one)->InsertCategory(MakeMugCategory()));
  EXPECT_TRUE((*two)->FindCategory("mug"));
  EXPECT_TRUE((*two)->InsertObject(MakeNewObject("a", ObjectRole::kNovel)));
  EXPECT_EQ((*one)->Count().value().objects, 1);
}

}  // namespace
}  // namespace graspdb
