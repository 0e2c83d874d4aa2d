#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "server/store/store.h"
#include "tests/support/faulty_vfs.h"
#include "tests/support/rounds.h"
#include "tests/support/stored_records.h"
#include "tests/support/temp_folder.h"

namespace graspdb {
namespace {

using ::testing::IsEmpty;

// A write that was acknowledged: an object, the grasp space that was learned
// from it, or that an object is deleted.
struct Acknowledgement {
  enum class Kind { kObject, kSpace, kDeletion } kind;
  std::string id;
};

// What a power cut would have left, and what had been acknowledged by then.
struct Image {
  std::string folder;
  size_t acknowledged;
};

class Worker {
 public:
  explicit Worker(Store& store) : store_(store) {}

  void Work(int i) {
    const auto object = store_.InsertObject(
        MakeNewObject("bytes " + std::to_string(i), ObjectRole::kExample));
    ASSERT_TRUE(object) << object.error().message;
    done_.push_back({Acknowledgement::Kind::kObject, object->id});
    const auto parts = store_.ListParts(object->id);
    const auto space = store_.InsertGraspSpace(MakeSpaceRecord((*parts)[0], 1),
                                               MakeGraspSpace(1, 5));
    ASSERT_TRUE(space);
    done_.push_back({Acknowledgement::Kind::kSpace, space->id});
    if (i % 5 != 4) return;
    const auto novel = store_.InsertObject(
        MakeNewObject("novel " + std::to_string(i), ObjectRole::kNovel));
    ASSERT_TRUE(novel);
    ASSERT_TRUE(store_.DeleteObject(novel->id, true));
    done_.push_back({Acknowledgement::Kind::kDeletion, novel->id});
  }

  const std::vector<Acknowledgement>& done() const { return done_; }

 private:
  Store& store_;
  std::vector<Acknowledgement> done_;
};

TEST(PowerLoss, LosesNothingThatWasAcknowledgedAndLeavesNothingHalf) {
  const int images_wanted = CountRounds(40);
  const TempFolder live;
  const TempFolder cuts;
  FaultyVfs& vfs = FaultyVfs::Get();
  vfs.Watch(live.path());
  Random random(11);
  std::vector<Image> images;
  std::vector<Acknowledgement> done;
  {
    auto store = Store::Open(live.File("a.db"));
    ASSERT_TRUE(store) << store.error().message;
    ASSERT_TRUE((*store)->InsertCategory(MakeMugCategory()));
    ASSERT_TRUE((*store)->InsertHand(MakeClaw()));
    Worker worker(**store);
    vfs.set_before_change([&] {
      if (random.NextUniform() >= 0.05 || std::ssize(images) == images_wanted) {
        return;
      }
      images.push_back(
          {cuts.File(std::to_string(images.size())), worker.done().size()});
      vfs.WriteImage(images.back().folder, random);
    });
    for (int i = 0; std::ssize(images) < images_wanted; ++i) {
      ASSERT_NO_FATAL_FAILURE(worker.Work(i));
    }
    done = worker.done();
    vfs.set_before_change(nullptr);
  }
  size_t most = 0;
  for (const Image& image : images) {
    auto store = Store::Open(image.folder + "/a.db");
    ASSERT_TRUE(store) << image.folder << ": " << store.error().message;
    for (size_t i = 0; i < image.acknowledged; ++i) {
      const auto& [kind, id] = done[i];
      switch (kind) {
        case Acknowledgement::Kind::kObject:
          ASSERT_TRUE((*store)->ReadObjectMeshes(id)) << image.folder;
          ASSERT_EQ((*store)->ListParts(id).value().size(), 2u);
          break;
        case Acknowledgement::Kind::kSpace:
          ASSERT_EQ((*store)->ReadGraspSpace(id).value().grasps.size(), 5u);
          break;
        case Acknowledgement::Kind::kDeletion:
          ASSERT_FALSE((*store)->FindObject(id)) << image.folder;
          break;
      }
    }
    ASSERT_THAT((*store)->Check().value().problems, IsEmpty()) << image.folder;
    most = std::max(most, image.acknowledged);
    store->reset();
    std::filesystem::remove_all(image.folder);
  }
  EXPECT_GT(most, 3U);
  RecordProperty("power_cuts", images_wanted);
  RecordProperty("acknowledged", static_cast<int>(most));
}

// The shim itself: what was not flushed is lost in some images, what was
// flushed in none.
TEST(PowerLoss, IsFeltByWhatWasNotFlushed) {
  const TempFolder live;
  FaultyVfs& vfs = FaultyVfs::Get();
  vfs.Watch(live.path());
  Random random(12);
  auto store = Store::Open(live.File("a.db"));
  ASSERT_TRUE((*store)->InsertCategory(MakeMugCategory()));
  int differing = 0;
  vfs.set_before_change([&] {
    const TempFolder cut;
    vfs.WriteImage(cut.path(), random);
    const std::string a = cut.File("a.db-wal");
    const std::string b = live.File("a.db-wal");
    std::string contents[2];
    for (int k = 0; k < 2; ++k) {
      std::ifstream in(k == 0 ? a : b, std::ios::binary);
      contents[k].assign(std::istreambuf_iterator<char>(in), {});
    }
    differing += contents[0] != contents[1];
  });
  ASSERT_TRUE((*store)->InsertHand(MakeClaw()));
  vfs.set_before_change(nullptr);
  EXPECT_GT(differing, 0);
}

}  // namespace
}  // namespace graspdb
