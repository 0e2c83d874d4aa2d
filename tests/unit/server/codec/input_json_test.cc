#include "server/codec/input_json.h"
#include "server/codec/order_json.h"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

#include "server/codec/record_json.h"
#include "tests/support/stored_records.h"

namespace graspdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

std::string ReadSource(const std::string& path) {
  std::ifstream file(std::string(GRASPDB_SOURCE_DIR) + "/" + path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(CategoryFromJson, ReadsEveryField) {
  const auto category = CategoryFromJson(
      R"({"name":"mug","title":"Mugs","parts":[{"label":"body"},)"
      R"({"label":"handle","tasks":{"use":"to drink"}}],)"
      R"("topology":[["body","handle"]],)"
      R"("segmentation":{"max_residual":0.2}})");
  ASSERT_TRUE(category) << category.error().message;
  EXPECT_EQ(category->parts[1].tasks.at("use"), "to drink");
  EXPECT_THAT(category->adjacency, ElementsAre(std::pair(0, 1)));
  EXPECT_EQ(category->segmentation.max_residual, 0.2);
}

TEST(CategoryFromJson, WhatWasWrittenIsReadButForItsTime) {
  const StoredCategory category = MakeMugCategory();
  std::string text = ToJson(category);
  const std::string time = R"(,"created_at":"")";
  text.erase(text.find(time), time.size());
  EXPECT_EQ(CategoryFromJson(text).value(), category);
}

TEST(CategoryFromJson, NamesTheFieldAtFault) {
  const auto field_of = [](const char* text) {
    const auto read = CategoryFromJson(text);
    return read ? "none" : read.error().field;
  };
  EXPECT_EQ(field_of("{}"), "name");
  EXPECT_EQ(field_of(R"({"name":"a"})"), "parts");
  EXPECT_EQ(field_of(R"({"name":"a","parts":{}})"), "parts");
  EXPECT_EQ(field_of(R"({"name":"a","parts":[{}]})"), "parts[0].label");
  EXPECT_EQ(field_of(R"({"name":"a","parts":[{"label":"b","tasks":{"t":1}}]})"),
            "parts[0].tasks.t");
  EXPECT_EQ(
      field_of(R"({"name":"a","parts":[{"label":"b","keep_free":{"t":1}}]})"),
      "parts[0].keep_free.t");
  EXPECT_EQ(field_of(R"({"name":"a","parts":[{"label":"b","tasks":{"t":""},)"
                     R"("keep_free":{"t":""}}]})"),
            "parts[0].keep_free");
  EXPECT_EQ(
      field_of(
          R"({"name":"a","parts":[{"label":"b"}],"topology":[["b","c"]]})"),
      "topology");
  EXPECT_EQ(field_of(R"({"name":"a","parts":[],"segmentation":{"samples":1}})"),
            "segmentation.samples");
  EXPECT_EQ(field_of(R"({"name":"a","parts":[],"colour":1})"), "colour");
}

TEST(PatchCategory, ChangesOnlyWhatIsGiven) {
  StoredCategory expected = MakeMugCategory();
  expected.title = "Cups";
  EXPECT_EQ(PatchCategory(MakeMugCategory(), R"({"title":"Cups"})").value(),
            expected);
  EXPECT_EQ(PatchCategory(MakeMugCategory(), R"({"name":"x"})").error().field,
            "name");
}

TEST(FaceLabels, ComeAsRangesOrOneByOne) {
  EXPECT_THAT(
      FaceLabelsFromJson(
          R"({"labels":["a","b"],"faces":{"b":[[2,3]],"a":[[0,2],[3,4]]}})")
          .value(),
      ElementsAre("a", "a", "b", "a"));
  EXPECT_THAT(FaceLabelsFromJson(R"({"face_labels":["a","b"]})").value(),
              ElementsAre("a", "b"));
}

TEST(FaceLabels, RangesLeaveNoFaceOutAndTakeNoneTwice) {
  for (const char* faces :
       {R"({"a":[[0,2]],"b":[[1,3]]})", R"({"a":[[0,2]],"b":[[3,4]]})",
        R"({"a":[[1,2]]})", R"({"a":[[0,0]]})", R"({"a":[[-1,2]]})",
        R"({"a":[[0,99999999999]]})", R"({"a":[0,1]})", R"({"a":[[0,1.5]]})",
        R"([])", R"({})"}) {
    EXPECT_FALSE(FaceLabelsFromJson(std::string(R"({"faces":)") + faces + "}"))
        << faces;
  }
}

TEST(DataFolder, ItsCategoriesLabelsAndHandsAreRead) {
  const auto mug = CategoryFileFromJson(ReadSource("data/mug/category.json"));
  ASSERT_TRUE(mug) << mug.error().message;
  EXPECT_EQ(mug->category.name, "mug");
  ASSERT_FALSE(mug->examples.empty());
  EXPECT_GE(mug->novel.size(), 3u);
  const auto labels =
      FaceLabelsFromJson(ReadSource("data/mug/" + mug->examples[0].labels));
  ASSERT_TRUE(labels) << labels.error().message;
  EXPECT_GT(labels->size(), 700u);
  const auto hand =
      HandFileFromJson(ReadSource("data/hands/barrett-bh8-280/hand.json"));
  ASSERT_TRUE(hand) << hand.error().message;
  EXPECT_THAT(hand->annotations.actuators, SizeIs(4));
  EXPECT_THAT(hand->annotations.breakaway, SizeIs(3));
  EXPECT_THAT(hand->annotations.contact_points, SizeIs(16));
}

TEST(HandFile, NamesTheFieldAtFault) {
  const auto field_of = [](const std::string& more) {
    const auto read =
        HandFileFromJson(R"({"name":"h","urdf":"h.urdf")" + more + "}");
    return read ? "none" : read.error().field;
  };
  EXPECT_EQ(field_of(""), "none");
  EXPECT_EQ(field_of(R"(,"approach_axis_H":[0,0,2])"), "approach_axis_H");
  EXPECT_EQ(field_of(R"(,"closing_force_n":0)"), "closing_force_n");
  EXPECT_EQ(field_of(R"(,"actuators":[{"name":"a"}])"), "actuators[0].joint");
  EXPECT_EQ(field_of(R"(,"contact_points":[{"link":"l","p_L":[0,0,0]}])"),
            "contact_points[0].nhat_L");
  EXPECT_EQ(field_of(R"(,"ignored_collisions":[["a"]])"), "ignored_collisions");
}

TEST(Orders, ComeBackFromTheJobsTableWithTheirPayload) {
  TransferOrder order;
  order.mesh.bytes = "mesh";
  order.mesh.file_name = "mug.stl";
  order.mesh.units = "mm";
  order.mesh.category = "auto";
  order.category = "auto";
  order.part_labels = {"handle"};
  order.count = 7;
  order.sources = 12;
  order.stage = GraspStage::kTransfer;
  order.parameters.contact.friction = 0.25;
  order.seed = 18446744073709551615u;
  const TransferOrder read =
      StoredTransferOrderFromJson(ToJson(order), MakePayload(order.mesh))
          .value();
  EXPECT_EQ(read.mesh.bytes, "mesh");
  EXPECT_EQ(read.mesh.file_name, "mug.stl");
  EXPECT_EQ(read.category, "auto");
  EXPECT_EQ(read.count, 7);
  EXPECT_EQ(read.stage, GraspStage::kTransfer);
  EXPECT_EQ(read.parameters, order.parameters);
  EXPECT_EQ(read.seed, order.seed);
  EXPECT_EQ(ToJson(read), ToJson(order));

  LearnOrder lesson;
  lesson.object_id = "o";
  lesson.hands = {"claw"};
  lesson.seed = 3;
  EXPECT_EQ(ToJson(StoredLearnOrderFromJson(ToJson(lesson)).value()),
            ToJson(lesson));
  ImportOrder import;
  import.role = ObjectRole::kExample;
  import.face_labels = {"a", "b"};
  import.learn = false;
  import.bytes = "mesh";
  const ImportOrder imported =
      StoredImportOrderFromJson(ToJson(import), MakePayload(import)).value();
  EXPECT_EQ(ToJson(imported), ToJson(import));
  EXPECT_EQ(imported.face_labels, import.face_labels);
  EXPECT_EQ(imported.bytes, "mesh");
}

TEST(Orders, OfAnImportSaysLittleHoweverManyLabelsThereAre) {
  ImportOrder order;
  order.face_labels.assign(100'000, "body");
  EXPECT_LT(ToJson(order).size(), 300u);
  const auto read =
      StoredImportOrderFromJson(ToJson(order), MakePayload(order));
  EXPECT_EQ(read.value().face_labels, order.face_labels);
}

TEST(Orders, OfAnImportThatWasStoredWithItsLabelsAreRead) {
  const auto read = StoredImportOrderFromJson(
      R"({"file_name":"","face_labels":["a","b"],"learn":true})", "mesh");
  EXPECT_THAT(read.value().face_labels, ElementsAre("a", "b"));
  EXPECT_EQ(read->bytes, "mesh");
}

TEST(Orders, WithFewerBytesOfLabelsThanTheySayAreRefused) {
  ImportOrder order;
  order.face_labels = {"a", "b"};
  EXPECT_EQ(StoredImportOrderFromJson(ToJson(order), "[\"a\"").error().field,
            "labels_bytes");
  EXPECT_FALSE(StoredImportOrderFromJson(ToJson(order), "[\"a\",\"b\"}"));
}

TEST(Orders, OfSegmentingAndVerifyingAreStoredWhole) {
  SegmentOrder segment;
  segment.object_id = "o";
  segment.category = "mug";
  segment.settings = R"({"samples":500})";
  segment.face_labels = {"body", "handle"};
  segment.seed = 7;
  segment.cascade = true;
  const SegmentOrder read = StoredSegmentOrderFromJson(ToJson(segment)).value();
  EXPECT_EQ(read.object_id, "o");
  EXPECT_EQ(read.category, "mug");
  EXPECT_EQ(read.settings, segment.settings);
  EXPECT_EQ(read.face_labels, segment.face_labels);
  EXPECT_EQ(read.seed, 7u);
  EXPECT_TRUE(read.cascade);

  VerifyOrder verify;
  verify.query.category = "mug";
  verify.query.part_labels = {"body"};
  verify.query.hand = "claw";
  verify.query.object_id = "o";
  verify.query.grasp_space_id = "g";
  verify.query.transfer_id = "t";
  verify.query.stage = GraspStage::kLearned;
  verify.limit = 5;
  verify.again = true;
  const VerifyOrder back = VerifyOrderFromJson(ToJson(verify)).value();
  EXPECT_EQ(ToJson(back), ToJson(verify));
  EXPECT_EQ(back.query.part_labels, verify.query.part_labels);
  EXPECT_EQ(back.query.stage, GraspStage::kLearned);
  EXPECT_EQ(back.limit, 5);
  EXPECT_TRUE(back.again);
  EXPECT_EQ(VerifyOrderFromJson("{}").value().limit, 1000);
}

TEST(Orders, ShortTextCannotAskForMuch) {
  EXPECT_EQ(
      SegmentOrderFromJson(R"({"faces":{"x":[[0,1000001]]}})").error().field,
      "faces.x");
  const std::string label(65, 'x');
  EXPECT_FALSE(
      SegmentOrderFromJson(R"({"faces":{")" + label + R"(":[[0,1]]}})"));
  std::string parts = "\"body\"";
  for (int i = 0; i < 64; ++i) parts += ",\"body\"";
  EXPECT_EQ(VerifyOrderFromJson(R"({"parts":[)" + parts + "]}").error().field,
            "parts");
}

TEST(Orders, BodiesOfRequestsAreChecked) {
  EXPECT_EQ(PartLabelFromJson(R"({"label":"handle"})").value(), "handle");
  EXPECT_EQ(PartLabelFromJson(R"({"label":""})").error().field, "label");
  EXPECT_EQ(LearnOrderFromJson(R"({"parameters":{"contact":{"friction":9}}})")
                .error()
                .field,
            "parameters.contact.friction");
  const auto order =
      SegmentOrderFromJson(R"({"settings":{"samples":500},"seed":2})");
  ASSERT_TRUE(order);
  EXPECT_EQ(order->settings, R"({"samples":500})");
  EXPECT_THAT(
      SegmentOrderFromJson(R"({"settings":{"samples":1}})").error().message,
      HasSubstr("segmentation.samples"));
}

}  // namespace
}  // namespace graspdb
