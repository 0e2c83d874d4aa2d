#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <sqlite3.h>

#include "server/store/store.h"
#include "tests/support/faulty_vfs.h"
#include "tests/support/rounds.h"
#include "tests/support/stored_records.h"
#include "tests/support/temp_folder.h"

namespace graspdb {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;

using Call = FaultyVfs::Call;

struct Fault {
  const char* name;
  int code;
  Call call{Call::kChange};
};

class IoError : public ::testing::TestWithParam<Fault> {};

// Whichever write fails, it says so, reads go on, the same write succeeds once
// the fault is gone, and nothing that was acknowledged is lost.
TEST_P(IoError, OfAnyCallIsToldAndHeals) {
  const TempFolder folder;
  FaultyVfs& vfs = FaultyVfs::Get();
  vfs.Watch(folder.path());
  auto store = Store::Open(folder.File("a.db"));
  ASSERT_TRUE(store) << store.error().message;
  ASSERT_TRUE((*store)->InsertCategory(MakeMugCategory()));
  std::vector<std::string> ids;
  int told = 0;
  for (int k = 1; k <= CountRounds(40); ++k) {
    vfs.FailAt(k, GetParam().code);
    for (int i = 0; !vfs.has_failed(); ++i) {
      const NewObject object = MakeNewObject(
          std::to_string(k) + "/" + std::to_string(i), ObjectRole::kExample);
      const auto stored = (*store)->InsertObject(object);
      if (stored) {
        // A checkpoint that fails is none of the write's concern.
        ids.push_back(stored->id);
        continue;
      }
      EXPECT_EQ(stored.error().code, ErrorCode::kStorage)
          << stored.error().message;
      ++told;
      if (!ids.empty()) {
        EXPECT_TRUE((*store)->FindObject(ids.back()));
      }
      vfs.FailAt(0, 0);
      const auto again = (*store)->InsertObject(object);
      ASSERT_TRUE(again) << "after call " << k << ": " << again.error().message;
      ids.push_back(again->id);
      break;
    }
    vfs.FailAt(0, 0);
  }
  EXPECT_GT(told, 5);
  for (const std::string& id : ids) {
    ASSERT_TRUE((*store)->ReadObjectMeshes(id));
  }
  EXPECT_THAT((*store)->Check().value().problems, IsEmpty());
  store->reset();
  auto reopened = Store::Open(folder.File("a.db"));
  ASSERT_TRUE(reopened) << reopened.error().message;
  EXPECT_EQ((*reopened)->Count().value().objects, std::ssize(ids));
  EXPECT_THAT((*reopened)->Check().value().problems, IsEmpty());
  RecordProperty("failed_calls", told);
}

INSTANTIATE_TEST_SUITE_P(Faults, IoError,
                         ::testing::Values(Fault{"Write", SQLITE_IOERR_WRITE},
                                           Fault{"Flush", SQLITE_IOERR_FSYNC},
                                           Fault{"DiskFull", SQLITE_FULL}),
                         [](const auto& fault) { return fault.param.name; });

class IoErrorWhileReading : public ::testing::TestWithParam<Fault> {};

// A database that cannot be opened or read says so, and is whole once it can.
TEST_P(IoErrorWhileReading, OfAnyCallIsToldAndHeals) {
  const TempFolder folder;
  FaultyVfs& vfs = FaultyVfs::Get();
  vfs.Watch("");
  const std::string path = folder.File("a.db");
  std::string id;
  TriangleMesh expected;
  {
    auto store = std::move(*Store::Open(path));
    ASSERT_TRUE(store->InsertCategory(MakeMugCategory()));
    for (int i = 0; i < 20; ++i) {
      id = store
               ->InsertObject(
                   MakeNewObject(std::to_string(i), ObjectRole::kExample))
               .value()
               .id;
    }
    expected = store->ReadObjectMeshes(id).value().canonical;
  }
  vfs.Watch(folder.path());
  std::set<std::string> told;
  bool failed = true;
  for (int k = 1; failed; ++k) {
    vfs.FailAt(k, GetParam().code, GetParam().call);
    // Whether it went well; if not, it says so.
    const auto expect_told = [&](const std::string& what, const auto& result) {
      if (result) return true;
      told.insert(what);
      EXPECT_EQ(result.error().code, ErrorCode::kStorage)
          << "call " << k << ": " << result.error().message;
      return false;
    };
    // Nothing of it is in memory yet.
    const auto opened = Store::Open(path, Store::OpenMode::kMustExist);
    if (expect_told("opening", opened)) {
      const auto meshes = (*opened)->ReadObjectMeshes(id);
      if (expect_told("a mesh", meshes)) {
        EXPECT_EQ(meshes->canonical, expected);
      }
      const auto objects = (*opened)->ListObjects({}, {});
      if (expect_told("a list", objects)) {
        EXPECT_EQ(objects->items.size(), 20u);
      }
    }
    failed = vfs.has_failed();
    vfs.FailAt(0, 0);
    if (opened) {
      const auto meshes = (*opened)->ReadObjectMeshes(id);
      ASSERT_TRUE(meshes) << "after call " << k << ": "
                          << meshes.error().message;
      EXPECT_EQ(meshes->canonical, expected);
      EXPECT_THAT((*opened)->Check().value().problems, IsEmpty());
    }
    const auto store = Store::Open(path, Store::OpenMode::kMustExist);
    ASSERT_TRUE(store) << "after call " << k << ": " << store.error().message;
    EXPECT_EQ((*store)->Count().value().objects, 20);
  }
  EXPECT_THAT(told, Contains("opening"));
  if (GetParam().call == Call::kRead) {
    EXPECT_THAT(told, IsSupersetOf({"a mesh", "a list"}));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Faults, IoErrorWhileReading,
    ::testing::Values(Fault{"Read", SQLITE_IOERR_READ, Call::kRead},
                      Fault{"Open", SQLITE_CANTOPEN, Call::kOpen}),
    [](const auto& fault) { return fault.param.name; });

// A database that cannot be made leaves nothing in the way of the next try.
TEST(IoErrorWhileCreating, IsToldAndHeals) {
  FaultyVfs& vfs = FaultyVfs::Get();
  int told = 0;
  bool failed = true;
  for (int k = 1; failed; ++k) {
    const TempFolder folder;
    vfs.Watch(folder.path());
    vfs.FailAt(k, SQLITE_FULL);
    {
      const auto store = Store::Open(folder.File("a.db"));
      // Beyond the last write of all there is nothing to fail.
      failed = vfs.has_failed();
      if (!store) {
        EXPECT_EQ(store.error().code, ErrorCode::kStorage);
        ++told;
      }
    }
    vfs.FailAt(0, 0);
    auto store = Store::Open(folder.File("a.db"));
    ASSERT_TRUE(store) << "after call " << k << ": " << store.error().message;
    EXPECT_TRUE((*store)->InsertCategory(MakeMugCategory()));
  }
  EXPECT_GT(told, 10);
}

}  // namespace
}  // namespace graspdb
