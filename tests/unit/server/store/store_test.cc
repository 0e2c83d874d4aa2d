#include "server/store/store.h"

#include <chrono>
#include <set>
#include <thread>

#include <gmock/gmock.h>

#include "server/ids.h"
#include "server/store/database.h"
#include "tests/support/stored_records.h"
#include "tests/support/temp_folder.h"

namespace graspdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class StoreTest : public ::testing::Test {
 protected:
  StoreTest() : store_(Open()) {
    EXPECT_TRUE(store_->InsertCategory(MakeMugCategory()));
    EXPECT_TRUE(store_->InsertHand(MakeClaw()));
  }
  std::unique_ptr<Store> Open() {
    auto store = Store::Open(folder_.File("a.db"));
    EXPECT_TRUE(store) << store.error().message;
    return std::move(*store);
  }
  void Reopen() {
    store_.reset();
    store_ = Open();
  }
  StoredObject AddObject(const std::string& bytes, ObjectRole role) {
    return store_->InsertObject(MakeNewObject(bytes, role)).value();
  }
  StoredGraspSpace AddSpace(const StoredObject& object, int part, uint64_t seed,
                            int num_grasps) {
    const auto parts = store_->ListParts(object.id).value();
    return store_
        ->InsertGraspSpace(MakeSpaceRecord(parts[part], seed),
                           MakeGraspSpace(seed, num_grasps))
        .value();
  }
  std::vector<StoredGrasp> GraspsOf(const StoredGraspSpace& space) {
    GraspQuery query;
    query.grasp_space_id = space.id;
    query.page.limit = 1000;
    return store_->QueryGrasps(query).value().items;
  }
  StoredTransfer AddTransfer(const StoredGraspSpace& space,
                             const StoredObject& novel) {
    const auto parts = store_->ListParts(novel.id).value();
    const NewTransfer transfer =
        MakeNewTransfer(space, GraspsOf(space), parts[1]);
    return store_->InsertTransfer(transfer.record, transfer.grasps).value();
  }

  TempFolder folder_;
  std::unique_ptr<Store> store_;
};

TEST_F(StoreTest, CategoriesComeBackAsTheyWere) {
  Reopen();
  StoredCategory expected = MakeMugCategory();
  StoredCategory found = store_->FindCategory("mug").value();
  EXPECT_THAT(found.created_at, SizeIs(24));
  expected.created_at = found.created_at;
  EXPECT_EQ(found, expected);
}

TEST_F(StoreTest, ACategoryNameIsTakenOnce) {
  StoredCategory category = MakeMugCategory();
  const auto again = store_->InsertCategory(category);
  ASSERT_TRUE(again);
  EXPECT_FALSE(again->created);
  category.title += "!";
  EXPECT_EQ(store_->InsertCategory(category).error().code,
            ErrorCode::kConflict);
}

TEST_F(StoreTest, UnknownNamesAreNotFoundWithTheKnownOnesInTheHint) {
  const auto category = store_->FindCategory("cup");
  ASSERT_FALSE(category);
  EXPECT_EQ(category.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(category.error().hint, "known: mug");
  EXPECT_EQ(store_->FindHand("x").error().hint, "known: claw");
  EXPECT_EQ(store_->FindObject("x").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(store_->FindPart("x").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(store_->FindGrasp("x").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(store_->FindGraspSpace("x").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(store_->FindTransfer("x").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(store_->FindJob("x").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(store_->ReadObjectMeshes("x").error().code, ErrorCode::kNotFound);
}

TEST_F(StoreTest, LabelsOfACategoryStayWhileObjectsUseThem) {
  StoredCategory category = MakeMugCategory();
  const auto change = [&](const StoredCategory&) -> Result<StoredCategory> {
    return category;
  };
  category.title = "Cups";
  category.parts[0].tasks.clear();
  EXPECT_EQ(store_->UpdateCategory("mug", change).value().title, "Cups");
  EXPECT_THAT(store_->FindCategory("mug").value().parts[0].tasks, IsEmpty());
  AddObject("a", ObjectRole::kNovel);
  category.parts[0].label = "bowl";
  EXPECT_EQ(store_->UpdateCategory("mug", change).error().code,
            ErrorCode::kConflict);
}

TEST_F(StoreTest, ChangesOfACategoryAtOnceAreBothKept) {
  constexpr int kEach = 50;
  const auto count_up =
      [](const StoredCategory& old) -> Result<StoredCategory> {
    StoredCategory category = old;
    category.title += "x";
    return category;
  };
  const auto title = [this] {
    return store_->FindCategory("mug").value().title;
  };
  const size_t before = title().size();
  const auto work = [&] {
    for (int i = 0; i < kEach; ++i) {
      EXPECT_TRUE(store_->UpdateCategory("mug", count_up));
    }
  };
  {
    std::jthread other(work);
    work();
  }
  EXPECT_EQ(title().size(), before + 2 * kEach);
}

TEST_F(StoreTest, WhatAChangeOfACategoryFailsWithIsToldAndNothingChanges) {
  const auto fail = [](const StoredCategory&) -> Result<StoredCategory> {
    return Error{ErrorCode::kInvalidArgument, "no"};
  };
  const StoredCategory before = store_->FindCategory("mug").value();
  EXPECT_EQ(store_->UpdateCategory("mug", fail).error().message, "no");
  EXPECT_EQ(store_->FindCategory("mug").value(), before);
}

TEST_F(StoreTest, HandsComeBackAsTheyWereAndTheSameOneAgainIsNoNews) {
  EXPECT_TRUE(store_->InsertHand(MakeClaw()));
  Reopen();
  const StoredHand hand = store_->FindHand("claw").value();
  EXPECT_EQ(hand.urdf, MakeClaw().urdf);
  EXPECT_EQ(hand.meshes, MakeClaw().meshes);
  EXPECT_THAT(store_->ListHands({}).value().items, SizeIs(1));
  StoredHand other = MakeClaw();
  other.sha256 = CalcSha256("other");
  EXPECT_EQ(store_->InsertHand(other).error().code, ErrorCode::kConflict);
}

TEST_F(StoreTest, ObjectsComeBackAsTheyWere) {
  const NewObject object =
      MakeNewObject(std::string("bytes\0of a mesh", 15), ObjectRole::kNovel);
  const StoredObject stored = store_->InsertObject(object).value();
  Reopen();
  const StoredObject found = store_->FindObject(stored.id).value();
  EXPECT_THAT(found.id, SizeIs(36));
  EXPECT_EQ(found.id[14], '7');  // The version of the UUID.
  EXPECT_EQ(found.sha256, object.record.sha256);
  EXPECT_EQ(found.repairs, object.record.repairs);
  EXPECT_EQ(found.segmentation, object.record.segmentation);
  EXPECT_EQ(found.box_max, object.record.box_max);
  EXPECT_EQ(found.mass.p_McCM, object.record.mass.p_McCM);
  EXPECT_EQ(store_->ReadObjectBytes(found.id).value(), object.bytes);
  EXPECT_EQ(store_->ReadObjectMeshes(found.id).value(), object.meshes);
  const auto parts = store_->ListParts(found.id).value();
  ASSERT_THAT(parts, SizeIs(2));
  EXPECT_EQ(parts[1].label, "handle");
  EXPECT_EQ(parts[1].faces, object.parts[1].faces);
  EXPECT_THAT(parts[1].adjacent, ElementsAre("body"));
  EXPECT_EQ(store_->FindPart(parts[1].id).value().object_id, found.id);
  const auto solids = store_->ReadSolids(parts).value();
  EXPECT_EQ(solids[1].solid_O, object.solids[1].solid_O);
  EXPECT_EQ(solids[1].confidence, 0.75);
}

TEST_F(StoreTest, ADecimatedMeshKeepsBothMeshesAndBothLabels) {
  NewObject object = MakeNewObject("a", ObjectRole::kNovel);
  object.meshes.work = MakePlainBox({0.081, 0.09, 0.1});
  object.meshes.work_labels = {1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0};
  const StoredObject stored = store_->InsertObject(object).value();
  EXPECT_EQ(store_->ReadObjectMeshes(stored.id).value(), object.meshes);
}

TEST_F(StoreTest, TheSameUploadIsStoredOnce) {
  const StoredObject first = AddObject("a", ObjectRole::kNovel);
  EXPECT_EQ(AddObject("a", ObjectRole::kNovel).id, first.id);
  EXPECT_NE(AddObject("b", ObjectRole::kNovel).id, first.id);
  EXPECT_NE(AddObject("a", ObjectRole::kExample).id, first.id);
  EXPECT_EQ(store_->Count().value().objects, 3);
  const auto found = store_->FindObjectByContent(CalcSha256("a"), "mm",
                                                 ObjectRole::kNovel, "mug");
  EXPECT_EQ(found.value()->id, first.id);
  EXPECT_FALSE(store_
                   ->FindObjectByContent(CalcSha256("a"), "cm",
                                         ObjectRole::kNovel, "mug")
                   .value());
}

TEST_F(StoreTest, ListsOfObjectsPageInOrderOfCreation) {
  std::vector<std::string> ids;
  for (int i = 0; i < 25; ++i) {
    ids.push_back(AddObject(std::to_string(i), ObjectRole::kNovel).id);
  }
  AddObject("example", ObjectRole::kExample);
  std::vector<std::string> listed;
  PageRequest page{7, ""};
  do {
    const auto items =
        store_->ListObjects({"mug", ObjectRole::kNovel}, page).value();
    for (const StoredObject& object : items.items) listed.push_back(object.id);
    page.cursor = items.next_cursor;
  } while (!page.cursor.empty());
  EXPECT_EQ(listed, ids);
  EXPECT_EQ(store_->ListObjects({}, {0, ""}).error().field, "limit");
}

TEST_F(StoreTest, GraspSpacesComeBackAsTheyWere) {
  const StoredObject example = AddObject("e", ObjectRole::kExample);
  const StoredGraspSpace record = AddSpace(example, 1, 5, 40);
  Reopen();
  EXPECT_EQ(store_->ReadGraspSpace(record.id).value(), MakeGraspSpace(5, 40));
  const StoredGraspSpace found = store_->FindGraspSpace(record.id).value();
  EXPECT_EQ(found.num_grasps, 40);
  EXPECT_EQ(found.curve, MakeGraspSpace(5, 0).curve);
  EXPECT_EQ(found.seconds, 12.5);
  EXPECT_EQ(found.configuration_space_seconds, 2.5);
  EXPECT_EQ(found.parameters, "{}");
}

TEST_F(StoreTest, NothingIsLearnedTwice) {
  const StoredObject example = AddObject("e", ObjectRole::kExample);
  const StoredGraspSpace first = AddSpace(example, 1, 5, 40);
  EXPECT_EQ(AddSpace(example, 1, 5, 99).id, first.id);
  EXPECT_EQ(store_->Count().value().grasps, 40);
  const auto known =
      store_->FindLearned(first.part_id, "claw", first.parameters_hash, 5);
  EXPECT_EQ(known.value()->id, first.id);
  EXPECT_FALSE(
      store_->FindLearned(first.part_id, "claw", first.parameters_hash, 6)
          .value());
  EXPECT_NE(AddSpace(example, 1, 6, 1).id, first.id);
}

TEST_F(StoreTest, GraspSpaceListsFilterAndPage) {
  const StoredObject example = AddObject("e", ObjectRole::kExample);
  for (uint64_t seed = 0; seed < 5; ++seed) AddSpace(example, 0, seed, 1);
  AddSpace(example, 1, 0, 1);
  const auto first =
      store_->ListGraspSpaces({"mug", "body", "claw", ""}, {3, ""}).value();
  ASSERT_THAT(first.items, SizeIs(3));
  const auto rest =
      store_
          ->ListGraspSpaces({"mug", "body", "claw", ""}, {3, first.next_cursor})
          .value();
  EXPECT_THAT(rest.items, SizeIs(2));
  EXPECT_EQ(rest.next_cursor, "");
  EXPECT_EQ(rest.items[1].seed, 4u);
  EXPECT_EQ(store_->ListGraspSpaces({}, {3, "x"}).error().field, "cursor");
}

TEST_F(StoreTest, TransfersComeBackAsTheyWere) {
  const StoredGraspSpace space =
      AddSpace(AddObject("e", ObjectRole::kExample), 1, 5, 9);
  const StoredObject novel = AddObject("n", ObjectRole::kNovel);
  const StoredTransfer transfer = AddTransfer(space, novel);
  Reopen();
  const StoredTransfer found = store_->FindTransfer(transfer.id).value();
  EXPECT_EQ(found.seed, 0xFFFFFFFFFFFFFFFF);
  EXPECT_EQ(found.warnings, transfer.warnings);
  EXPECT_THAT(found.seconds,
              ElementsAre(std::pair<std::string, double>("segment", 0.25),
                          std::pair<std::string, double>("replan", 1.5)));
  EXPECT_THAT(found.part_labels, ElementsAre("handle"));
  EXPECT_THAT(found.keep_free, ElementsAre("body"));
  ASSERT_THAT(found.attempts, SizeIs(9));
  EXPECT_EQ(found.attempts[1].assembly, TransferOutcome::kPalmCollision);
  EXPECT_EQ(found.attempts[1].assembled_grasp_id, "");
  EXPECT_EQ(found.contact_maps[0].alignment.X_NE,
            transfer.contact_maps[0].alignment.X_NE);
  const StoredGrasp grasp =
      store_->FindGrasp(found.attempts[2].assembled_grasp_id).value();
  EXPECT_EQ(grasp.stage, GraspStage::kAssembly);
  EXPECT_EQ(grasp.robust, 0.96875);
  EXPECT_EQ(grasp.grip, 0.625);
  EXPECT_EQ(grasp.physical, std::nullopt);
  EXPECT_EQ(grasp.targets_O[1], std::nullopt);
  EXPECT_EQ(grasp.targets_O[2], Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(grasp.source_grasp_id, found.attempts[2].source_grasp_id);
  EXPECT_EQ(grasp.seed, 0xFFFFFFFFFFFFFFFF);
  EXPECT_EQ(grasp.parameters_hash, transfer.parameters_hash);
}

TEST_F(StoreTest, QueriesLeaveOutGraspsTooNearWhatIsKeptFree) {
  const StoredGraspSpace space =
      AddSpace(AddObject("e", ObjectRole::kExample), 1, 5, 9);
  GraspQuery query;
  query.keep_free = {"body"};
  query.min_clearance = 0.005;
  const auto found = store_->QueryGrasps(query).value().items;
  EXPECT_THAT(found, SizeIs(4));  // 5, 6, 7 and 8 mm.
  for (const StoredGrasp& grasp : found) {
    EXPECT_GE(grasp.clearances.at("body"), 0.005);
    EXPECT_THAT(grasp.clearances, SizeIs(1));
  }
  query.keep_free = {"lid"};  // No grasp's object has one.
  EXPECT_THAT(store_->QueryGrasps(query).value().items, SizeIs(9));
}

TEST_F(StoreTest, PhysicalVerdictsAreKeptAndCanBeAskedFor) {
  const StoredGraspSpace space =
      AddSpace(AddObject("e", ObjectRole::kExample), 1, 5, 4);
  const std::vector<StoredGrasp> grasps = GraspsOf(space);
  ASSERT_TRUE(store_->SetPhysical(
      {{grasps[0].id, 1.0}, {grasps[1].id, 0.5}, {"unknown", 1.0}}));
  Reopen();
  EXPECT_EQ(store_->FindGrasp(grasps[0].id)->physical, 1.0);
  EXPECT_EQ(store_->FindGrasp(grasps[1].id)->physical, 0.5);
  EXPECT_EQ(store_->FindGrasp(grasps[2].id)->physical, std::nullopt);
  GraspQuery query;
  query.held = true;
  const auto held = store_->QueryGrasps(query).value().items;
  ASSERT_THAT(held, SizeIs(1));
  EXPECT_EQ(held[0].id, grasps[0].id);

  // What held comes first, what slipped last, across pages.
  query = {};
  query.category = "mug";
  query.sort = GraspQuery::Sort::kMerit;
  query.page.limit = 2;
  std::vector<StoredGrasp> ranked;
  do {
    const auto page = store_->QueryGrasps(query).value();
    ranked.insert(ranked.end(), page.items.begin(), page.items.end());
    query.page.cursor = page.next_cursor;
  } while (!query.page.cursor.empty());
  ASSERT_GE(ranked.size(), 3u);
  EXPECT_EQ(ranked.front().id, grasps[0].id);
  EXPECT_EQ(ranked.back().id, grasps[1].id);
  for (size_t i = 2; i + 1 < ranked.size(); ++i) {
    EXPECT_GE(ranked[i - 1].grip.value_or(0.0), ranked[i].grip.value_or(0.0));
  }
}

TEST_F(StoreTest, ATransferIsStoredOnce) {
  const StoredGraspSpace space =
      AddSpace(AddObject("e", ObjectRole::kExample), 1, 5, 9);
  const StoredObject novel = AddObject("n", ObjectRole::kNovel);
  AddTransfer(space, novel);
  AddTransfer(space, novel);
  EXPECT_EQ(store_->Count().value().transfers, 1);
  EXPECT_EQ(store_->Count().value().grasps, 9 + 5);
}

TEST_F(StoreTest, OfTransfersThatWereCutTheOneWithTheMostGraspsStays) {
  const StoredGraspSpace space =
      AddSpace(AddObject("e", ObjectRole::kExample), 1, 5, 9);
  const StoredObject novel = AddObject("n", ObjectRole::kNovel);
  const auto add = [&](const std::string& id, int num_sources, bool complete) {
    auto sources = GraspsOf(space);
    std::erase_if(sources, [](const StoredGrasp& grasp) {
      return grasp.stage != GraspStage::kLearned;
    });
    sources.resize(static_cast<size_t>(num_sources));
    NewTransfer made =
        MakeNewTransfer(space, sources, store_->ListParts(novel.id).value()[1]);
    made.record.inputs_id = MakeContentId("all sources");
    made.record.id = MakeContentId(id);
    made.record.complete = complete;
    for (size_t i = 0; i < made.grasps.size(); ++i) {
      made.grasps[i].id = MakeContentId(id + std::to_string(i));
      made.grasps[i].transfer_id = made.record.id;
    }
    made.record.attempts.clear();
    made.record.contact_maps.clear();
    const auto stored = store_->InsertTransfer(made.record, made.grasps);
    return stored ? stored->id : stored.error().message;
  };
  const std::string first = add("first", 4, false);
  EXPECT_EQ(add("lesser", 2, false), first);
  EXPECT_EQ(add("as many", 4, false), first);
  const std::string more = add("more", 6, false);
  EXPECT_EQ(more, MakeContentId("more"));
  EXPECT_FALSE(store_->FindTransfer(first));
  const std::string whole = add("all sources", 2, true);
  EXPECT_FALSE(store_->FindTransfer(more));
  EXPECT_EQ(add("late", 9, false), whole);
  EXPECT_EQ(store_->Count().value().transfers, 1);
}

// The oracle: all grasps, filtered and sorted in memory.
TEST_F(StoreTest, QueriesGiveEveryMatchingGraspOnceInOrderOnPages) {
  const StoredObject example = AddObject("e", ObjectRole::kExample);
  const StoredGraspSpace handle = AddSpace(example, 1, 5, 60);
  AddSpace(example, 0, 6, 70);
  AddTransfer(handle, AddObject("n", ObjectRole::kNovel));

  GraspQuery everything;
  everything.page.limit = 1000;
  const std::vector<StoredGrasp> all =
      store_->QueryGrasps(everything).value().items;
  ASSERT_THAT(all, SizeIs(60 + 70 + 30));

  using Sort = GraspQuery::Sort;
  for (const Sort sort : {Sort::kEpsilon, Sort::kHybrid, Sort::kRobust}) {
    for (int mask = 0; mask < 16; ++mask) {
      GraspQuery query;
      query.sort = sort;
      query.page.limit = 9;
      if (mask & 1) query.part_labels = {"handle"};
      if (mask & 2) query.min_epsilon = 0.4;
      if (mask & 4) query.stage = GraspStage::kLearned;
      if (mask & 8) query.category = "mug";
      std::vector<double> expected;
      const auto key = [&](const StoredGrasp& grasp) {
        if (sort == Sort::kEpsilon) return -grasp.grasp.quality.epsilon;
        if (sort == Sort::kHybrid) return grasp.grasp.quality.hybrid;
        return -grasp.robust.value_or(-1.0);
      };
      for (const StoredGrasp& grasp : all) {
        if ((mask & 1) && grasp.part_label != "handle") continue;
        if ((mask & 2) && grasp.grasp.quality.epsilon < 0.4) continue;
        if ((mask & 4) && grasp.stage != GraspStage::kLearned) continue;
        expected.push_back(key(grasp));
      }
      std::sort(expected.begin(), expected.end());
      std::vector<double> found;
      std::set<std::string> ids;
      do {
        const auto page = store_->QueryGrasps(query).value();
        for (const StoredGrasp& grasp : page.items) {
          found.push_back(key(grasp));
          ids.insert(grasp.id);
        }
        query.page.cursor = page.next_cursor;
      } while (!query.page.cursor.empty());
      EXPECT_EQ(found, expected) << "mask " << mask;
      EXPECT_EQ(ids.size(), expected.size());
    }
  }
}

TEST_F(StoreTest, ACursorOfAnotherSortOrNoneIsRefused) {
  AddSpace(AddObject("e", ObjectRole::kExample), 1, 5, 9);
  GraspQuery query;
  query.page.limit = 2;
  query.page.cursor = store_->QueryGrasps(query).value().next_cursor;
  EXPECT_TRUE(store_->QueryGrasps(query));
  query.sort = GraspQuery::Sort::kHybrid;
  EXPECT_EQ(store_->QueryGrasps(query).error().field, "cursor");
  for (const char* cursor : {"e", "e12", "' OR 1=1", "ezzzzzzzzzzzzzzzzz1"}) {
    query.page.cursor = cursor;
    EXPECT_EQ(store_->QueryGrasps(query).error().code,
              ErrorCode::kInvalidArgument);
  }
}

TEST_F(StoreTest, AnExampleThatGraspsDependOnGoesOnlyWithCascade) {
  const StoredObject example = AddObject("e", ObjectRole::kExample);
  const StoredGraspSpace space = AddSpace(example, 1, 5, 9);
  const StoredObject novel = AddObject("n", ObjectRole::kNovel);
  const StoredTransfer transfer = AddTransfer(space, novel);
  const auto refused = store_->DeleteObject(example.id, false);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
  EXPECT_THAT(refused.error().message, HasSubstr(space.id));
  EXPECT_THAT(refused.error().message, HasSubstr(transfer.id));
  EXPECT_TRUE(store_->DeleteObject(example.id, true));
  const StoreCounts counts = store_->Count().value();
  EXPECT_EQ(counts.objects, 1);
  EXPECT_EQ(counts.grasps + counts.transfers + counts.grasp_spaces, 0);
  EXPECT_THAT(store_->Check().value().problems, IsEmpty());
}

TEST_F(StoreTest, ANovelObjectGoesWithItsGrasps) {
  const StoredGraspSpace space =
      AddSpace(AddObject("e", ObjectRole::kExample), 1, 5, 9);
  const StoredObject novel = AddObject("n", ObjectRole::kNovel);
  AddTransfer(space, novel);
  EXPECT_TRUE(store_->DeleteObject(novel.id, false));
  EXPECT_EQ(store_->Count().value().grasps, 9);
  EXPECT_EQ(store_->Count().value().transfers, 0);
  EXPECT_THAT(store_->Check().value().problems, IsEmpty());
}

TEST_F(StoreTest, AGraspSpaceThatWasTransferredGoesOnlyWithCascade) {
  const StoredGraspSpace space =
      AddSpace(AddObject("e", ObjectRole::kExample), 1, 5, 9);
  AddTransfer(space, AddObject("n", ObjectRole::kNovel));
  EXPECT_EQ(store_->DeleteGraspSpace(space.id, false).error().code,
            ErrorCode::kConflict);
  EXPECT_TRUE(store_->DeleteGraspSpace(space.id, true));
  EXPECT_EQ(store_->Count().value().grasps, 0);
  EXPECT_EQ(store_->Count().value().transfers, 0);
}

TEST_F(StoreTest, ParametersGoWithTheLastThatUsedThem) {
  const auto count_parameter_sets = [&] {
    return Database(store_->path(), Database::Mode::kReadOnly)
        .QueryInt("SELECT count(*) FROM parameter_sets");
  };
  const StoredObject example = AddObject("e", ObjectRole::kExample);
  const StoredGraspSpace one = AddSpace(example, 1, 5, 9);
  const StoredGraspSpace other = AddSpace(example, 1, 6, 9);
  AddTransfer(one, AddObject("n", ObjectRole::kNovel));
  EXPECT_EQ(count_parameter_sets(), 2);
  EXPECT_TRUE(store_->DeleteGraspSpace(one.id, true));
  EXPECT_EQ(count_parameter_sets(), 1);
  EXPECT_TRUE(store_->DeleteGraspSpace(other.id, false));
  EXPECT_EQ(count_parameter_sets(), 0);
}

TEST_F(StoreTest, ACategoryGoesWithEverythingInItOnlyWithCascade) {
  const StoredGraspSpace space =
      AddSpace(AddObject("e", ObjectRole::kExample), 1, 5, 9);
  AddTransfer(space, AddObject("n", ObjectRole::kNovel));
  EXPECT_EQ(store_->DeleteCategory("mug", false).error().code,
            ErrorCode::kConflict);
  EXPECT_TRUE(store_->DeleteCategory("mug", true));
  StoreCounts expected;
  expected.hands = 1;
  EXPECT_EQ(store_->Count().value(), expected);
  EXPECT_THAT(store_->Check().value().problems, IsEmpty());
}

TEST_F(StoreTest, NewPartsReplaceTheOldOnesButNotUnderGraspsThatUseThem) {
  const StoredObject example = AddObject("e", ObjectRole::kExample);
  NewObject other = MakeNewObject("e", ObjectRole::kExample);
  other.parts.pop_back();
  other.solids.pop_back();
  other.record.segmentation.method = "labels";
  const auto replace = [&](bool cascade) {
    return store_->ReplaceParts(example.id, "mug", other.record.segmentation,
                                other.meshes, other.parts, other.solids,
                                cascade);
  };
  EXPECT_EQ(replace(false).value().segmentation.method, "labels");
  EXPECT_THAT(store_->ListParts(example.id).value(), SizeIs(1));
  AddSpace(example, 0, 1, 3);
  EXPECT_EQ(replace(false).error().code, ErrorCode::kConflict);
  EXPECT_TRUE(replace(true));
  EXPECT_EQ(store_->Count().value().grasps, 0);
}

TEST_F(StoreTest, PartsMadeOfOthersThanThereAreNowAreAConflict) {
  const StoredObject example = AddObject("e", ObjectRole::kExample);
  const auto before = store_->ListParts(example.id).value();
  NewObject other = MakeNewObject("e", ObjectRole::kExample);
  other.parts.pop_back();
  other.solids.pop_back();
  const auto replace = [&](const Store::PartIds& instead_of) {
    return store_->ReplaceParts(example.id, "mug", other.record.segmentation,
                                other.meshes, other.parts, other.solids, false,
                                instead_of);
  };
  const Store::PartIds both{{before[0].id, before[1].id}};
  EXPECT_TRUE(replace(both));
  EXPECT_EQ(replace(both).error().code, ErrorCode::kConflict);
  EXPECT_EQ(store_->ReadSolids(before).error().code, ErrorCode::kConflict);
}

TEST_F(StoreTest, LabelsThatTheCategoryDoesNotHaveAreAConflict) {
  NewObject misnamed = MakeNewObject("a", ObjectRole::kExample);
  misnamed.parts[1].label = "spout";
  NewObject beyond = MakeNewObject("b", ObjectRole::kExample);
  beyond.meshes.canonical_labels.back() = 2;
  for (const NewObject& object : {misnamed, beyond}) {
    EXPECT_EQ(store_->InsertObject(object).error().code, ErrorCode::kConflict);
  }
  EXPECT_EQ(store_->Count().value().objects, 0);
}

TEST_F(StoreTest, JobsAreClaimedOnceInOrderSlowOnesApart) {
  const std::string first =
      store_->InsertJob(JobKind::kTransfer, false, "{}", "mesh", {}).value().id;
  store_->InsertJob(JobKind::kLearn, true, "{}", "", {}).value();
  const std::string third =
      store_->InsertJob(JobKind::kTransfer, false, "{}", "", {}).value().id;
  EXPECT_EQ(store_->ClaimJob(false).value()->id, first);
  EXPECT_EQ(store_->ReadJobPayload(first).value(), "mesh");
  EXPECT_EQ(store_->ClaimJob(false).value()->id, third);
  EXPECT_FALSE(store_->ClaimJob(false).value());
  EXPECT_EQ(store_->FindJob(first).value().state, JobState::kRunning);
}

TEST_F(StoreTest, AJobEndsOnceWithItsErrorAndWithoutItsPayload) {
  StoredJob job =
      store_->InsertJob(JobKind::kImport, false, "{}", "m", {}).value();
  job.state = JobState::kFailed;
  job.error = Error{ErrorCode::kUnusableInput, "no mesh", "try stl", "format"};
  EXPECT_EQ(store_->FinishJob(job).value().error, job.error);
  EXPECT_EQ(store_->ReadJobPayload(job.id).value(), "");
  job.state = JobState::kSucceeded;
  EXPECT_EQ(store_->FinishJob(job).value().state, JobState::kFailed);
}

TEST_F(StoreTest, JobsThatADeadProcessLeftRunningAreQueuedAgain) {
  store_->InsertJob(JobKind::kLearn, true, "{}", "", {}).value();
  store_->ClaimJob(true).value();
  Reopen();
  EXPECT_EQ(store_->RequeueRunningJobs(true).value().num_queued, 1);
  EXPECT_TRUE(store_->ClaimJob(true).value());
}

TEST_F(StoreTest, AJobThatKilledThreeProcessesFails) {
  const auto job =
      store_->InsertJob(JobKind::kLearn, true, "{}", "", {}).value();
  const auto claim = [&] { return store_->ClaimJob(true).value().has_value(); };
  for (int i = 0; i < 5; ++i) {  // Interruptions in good order do not count.
    EXPECT_TRUE(claim());
    EXPECT_EQ(store_->RequeueRunningJobs(false).value().num_queued, 1);
  }
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(claim());
    EXPECT_EQ(store_->RequeueRunningJobs(true).value().num_queued, 1);
  }
  EXPECT_TRUE(claim());
  const RequeuedJobs left = store_->RequeueRunningJobs(true).value();
  EXPECT_EQ(left.num_queued, 0);
  ASSERT_EQ(left.given_up.size(), 1U);
  EXPECT_EQ(left.given_up[0].id, job.id);
  EXPECT_EQ(store_->FindJob(job.id).value().state, JobState::kFailed);
}

TEST_F(StoreTest, JobsWithTheSameIdempotencyKeyAreOne) {
  const auto first =
      store_->InsertJob(JobKind::kLearn, true, "{}", "", {"k"}).value();
  EXPECT_EQ(
      store_->InsertJob(JobKind::kLearn, true, "{}", "", {"k"}).value().id,
      first.id);
  EXPECT_EQ(
      store_->InsertJob(JobKind::kLearn, true, "[]", "", {"k"}).error().code,
      ErrorCode::kKeyReused);
  EXPECT_EQ(
      store_->InsertJob(JobKind::kLearn, true, "{}", "m", {"k"}).error().code,
      ErrorCode::kKeyReused);
}

TEST_F(StoreTest, NoMoreJobsAreQueuedThanAllowed) {
  const auto insert = [&](bool slow, const std::string& key) {
    return store_->InsertJob(JobKind::kLearn, slow, "{}", "", {key}, 2);
  };
  EXPECT_TRUE(insert(true, "first"));
  EXPECT_TRUE(insert(true, ""));
  EXPECT_EQ(insert(true, "").error().code, ErrorCode::kOverloaded);
  EXPECT_TRUE(insert(true, "first"));  // Is queued already …
  EXPECT_TRUE(insert(false, ""));      // … and this waits in another queue.
  store_->ClaimJob(true).value();
  EXPECT_TRUE(insert(true, ""));
}

TEST_F(StoreTest, AJobThatIsOverdueFailsAndGivesPlaceAndKeyBack) {
  const auto insert = [&](double deadline) {
    return store_->InsertJob(JobKind::kLearn, true, "{}", "payload",
                             {"key", deadline}, 1);
  };
  const std::string first = insert(0.001).value().id;
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const auto failed = store_->FailOverdueJobs().value();
  ASSERT_EQ(failed.size(), 1U);
  EXPECT_EQ(failed[0].id, first);
  EXPECT_TRUE(store_->FailOverdueJobs().value().empty());
  const std::string second = insert(1e3).value().id;
  EXPECT_NE(second, first);
  const StoredJob missed = store_->FindJob(first).value();
  EXPECT_EQ(missed.state, JobState::kFailed);
  EXPECT_EQ(missed.error.value().code, ErrorCode::kDeadlineExceeded);
  EXPECT_EQ(store_->ReadJobPayload(first).value(), "");
  EXPECT_EQ(store_->ClaimJob(true).value()->id, second);
}

TEST_F(StoreTest, AJobThatEndedIsForgottenAfterAWeek) {
  const auto insert = [&] {
    return store_->InsertJob(JobKind::kLearn, true, "{}", "", {}).value();
  };
  StoredJob ended = insert();
  StoredJob late = insert();
  const StoredJob queued = insert();
  ended.state = late.state = JobState::kSucceeded;
  ASSERT_TRUE(store_->FinishJob(ended));
  ASSERT_TRUE(store_->FinishJob(late));
  insert();
  EXPECT_TRUE(store_->FindJob(ended.id));
  // As if all had been submitted ten days ago, and the first one ended then.
  constexpr int64_t kTenDays = int64_t{10} * 24 * 3600 * 1000;
  const int64_t then = CalcUnixMilliseconds() - kTenDays;
  const std::string before = MakeUuidBound(then);
  const auto age = [&](const std::string& id) {
    return before + id.substr(13);
  };
  {
    Database database(store_->path(), Database::Mode::kReadWrite);
    database.Prepare("UPDATE jobs SET finished_at = ? WHERE id = ?")
        .Bind(FormatTime(then), ended.id)
        .Run();
    for (const std::string& id : {ended.id, late.id, queued.id}) {
      database.Prepare("UPDATE jobs SET id = ? WHERE id = ?")
          .Bind(age(id), id)
          .Run();
    }
  }
  insert();
  EXPECT_EQ(store_->FindJob(age(ended.id)).error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(store_->FindJob(age(late.id)));
  EXPECT_TRUE(store_->FindJob(age(queued.id)));
}

TEST_F(StoreTest, JobsAreListedNewestFirst) {
  std::vector<std::string> ids;
  for (int i = 0; i < 5; ++i) {
    ids.insert(
        ids.begin(),
        store_->InsertJob(JobKind::kLearn, true, "{}", "", {}).value().id);
  }
  const auto page = store_->ListJobs(std::nullopt, {3, ""}).value();
  ASSERT_THAT(page.items, SizeIs(3));
  EXPECT_EQ(page.items[0].id, ids[0]);
  const auto rest =
      store_->ListJobs(JobState::kQueued, {3, page.next_cursor}).value();
  ASSERT_THAT(rest.items, SizeIs(2));
  EXPECT_EQ(rest.items[1].id, ids[4]);
}

TEST_F(StoreTest, TheFirstReplyUnderAKeyStays) {
  const StoredReply reply{"key",
                          std::string(64, 'a'),
                          201,
                          {{"Location", "/v1/x: y"}, {"ETag", ""}},
                          std::string("\0{}", 3)};
  EXPECT_TRUE(store_->InsertReply(reply));
  StoredReply other = reply;
  other.body = "no";
  EXPECT_TRUE(store_->InsertReply(other));
  const auto found = store_->FindReply("key").value();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->body, reply.body);
  EXPECT_EQ(found->headers, reply.headers);
  EXPECT_FALSE(store_->FindReply("other").value());
}

TEST_F(StoreTest, WritersAndReadersOfManyThreadsNeverSeeALock) {
  constexpr int kThreads = 8;
  constexpr int kEach = 25;
  std::vector<std::thread> threads;
  std::atomic<int> failures{0};
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < kEach; ++i) {
        const std::string bytes = std::to_string(t) + "-" + std::to_string(i);
        const auto stored =
            store_->InsertObject(MakeNewObject(bytes, ObjectRole::kNovel));
        if (!stored || !store_->FindObject(stored->id) ||
            !store_->ListObjects({}, {})) {
          ++failures;
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(failures, 0);
  EXPECT_EQ(store_->Count().value().objects, kThreads * kEach);
}

}  // namespace
}  // namespace graspdb
