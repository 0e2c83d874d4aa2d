#include "server/jobs/service.h"
#include "server/files.h"
#include "server/jobs/data_folder.h"

#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>

#include "server/codec/input_json.h"
#include "server/codec/order_json.h"
#include "server/codec/record_json.h"
#include "server/decode/decode_client.h"
#include "tests/support/temp_folder.h"

namespace graspdb {
namespace {

using std::chrono::milliseconds;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

// For a job to end, on a busy machine and under a sanitizer, too.
constexpr std::chrono::seconds kLongEnough{600};

namespace fs = std::filesystem;

const std::string kData = std::string(GRASPDB_SOURCE_DIR) + "/data";

// Little is learned and quickly: enough for the verbs, not for good grasps.
Parameters MakeQuickParameters() {
  Parameters parameters;
  parameters.active_learning.seed_samples = 200;
  parameters.active_learning.rounds = 1;
  parameters.active_learning.queries_per_round = 50;
  parameters.active_learning.test_samples = 50;
  parameters.swarm.particles = 50;
  parameters.swarm.iterations = 5;
  parameters.swarm.target_grasps = 12;
  parameters.swarm.min_grip = 0.0;  // Rare among so few tries.
  return parameters;
}

std::unique_ptr<Service> MakeService(const std::string& db, int threads = 0) {
  auto store = Store::Open(db);
  EXPECT_TRUE(store) << store.error().message;
  DecoderOptions decoder;
  decoder.helper = GRASPDB_DECODE_HELPER;
  ServiceOptions options;
  options.threads = threads;
  options.max_mesh_bytes = 4 << 20;
  return std::make_unique<Service>(std::move(*store),
                                   std::make_unique<Decoder>(decoder), options);
}

ImportOrder MakeNovelOrder(const std::string& name = "latte") {
  ImportOrder order;
  order.bytes = ReadFileBytes(kData + "/mug/" + name + ".obj").value();
  order.file_name = name + ".obj";
  order.category = "mug";
  return order;
}

// A box of the given size in metres, as an OBJ file.
std::string MakeBoxFile(double size) {
  std::ostringstream text;
  for (int i = 0; i < 8; ++i) {
    text << "v " << (i & 1 ? size : 0) << ' ' << (i & 2 ? size : 0) << ' '
         << (i & 4 ? size : 0) << '\n';
  }
  text << "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\n"
          "f 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6\n";
  return text.str();
}

/** Two databases made once: `imported` has the example mug and the hand,
 `learned` also the example's body learned and one novel mug. Each test works on
 a copy. */
class ServiceTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    suite_ = std::make_unique<TempFolder>();
    {
      const auto service = MakeService(suite_->File("imported.db"));
      PopulateOrder order;
      order.folder = kData;
      order.learn = false;
      ExecutionContext quiet;
      const auto populated = Populate(*service, order, quiet);
      ASSERT_TRUE(populated) << populated.error().message;
    }
    fs::copy(suite_->File("imported.db"), suite_->File("learned.db"));
    const auto service = MakeService(suite_->File("learned.db"));
    LearnOrder lesson;
    lesson.object_id = FindExample(*service);
    lesson.part_labels = {"body"};
    lesson.parameters = MakeQuickParameters();
    ExecutionContext context;
    const auto learned = service->LearnObject(lesson, context);
    ASSERT_TRUE(learned) << learned.error().message;
    ASSERT_GT(learned->at(0).num_grasps, 3);
    ASSERT_TRUE(service->ImportObject(MakeNovelOrder(), context));
  }
  static void TearDownTestSuite() { suite_.reset(); }

  static std::string FindExample(const Service& service) {
    return service.store()
        .ListObjects({"mug", ObjectRole::kExample}, {})
        .value()
        .items.at(0)
        .id;
  }

  std::string Copy(const std::string& which) {
    const std::string path =
        folder_.File(which + std::to_string(++copies_) + ".db");
    fs::copy(suite_->File(which + ".db"), path);
    return path;
  }

  TransferOrder MakeOrder() const {
    TransferOrder order;
    order.mesh = MakeNovelOrder();
    order.category = "mug";
    order.part_labels = {"body"};
    order.sources = 4;
    order.parameters.replan.climb_samples = 10;
    return order;
  }

  static std::unique_ptr<TempFolder> suite_;
  TempFolder folder_;
  int copies_{0};
  ExecutionContext context_;
};

std::unique_ptr<TempFolder> ServiceTest::suite_;

// ---- Categories and hands ---------------------------------------------------

TEST_F(ServiceTest, CategoriesHavePlainNamesAndDifferentLabels) {
  const auto service = MakeService(Copy("imported"));
  const auto field_of = [&](const char* text) {
    const auto added = service->AddCategory(CategoryFromJson(text).value());
    return added ? "none" : added.error().field;
  };
  EXPECT_EQ(field_of(R"({"name":"Mug!","parts":[{"label":"a"}]})"), "name");
  EXPECT_EQ(field_of(R"({"name":"auto","parts":[{"label":"a"}]})"), "name");
  EXPECT_EQ(field_of(R"({"name":"../x","parts":[{"label":"a"}]})"), "name");
  EXPECT_EQ(field_of(R"({"name":"pan","parts":[]})"), "parts");
  EXPECT_EQ(field_of(R"({"name":"pan","parts":[{"label":"a"},{"label":"a"}]})"),
            "parts");
  EXPECT_EQ(field_of(R"({"name":"pan","parts":[{"label":"a"}]})"), "none");
  EXPECT_EQ(field_of(R"({"name":"pan","parts":[{"label":"a"}]})"), "none");
  EXPECT_EQ(field_of(R"({"name":"pan","parts":[{"label":"b"}]})"), "name");
}

TEST_F(ServiceTest, AHandIsAddedOnceAndOnlyIfItCanBeRead) {
  const auto service = MakeService(Copy("imported"));
  const StoredHand hand = service->store().FindHand(kDefaultHand).value();
  EXPECT_THAT(hand.meshes, Not(IsEmpty()));
  EXPECT_EQ(service->FindHandModel(kDefaultHand).value()->num_joints(), 8);
  HandFiles files;
  files.annotations = R"({"name":"claw","urdf":"claw.urdf"})";
  files.urdf = "<robot name=\"claw\"><link name=\"a\"";
  EXPECT_FALSE(service->AddHand(files, ExecutionContext()));
  EXPECT_FALSE(service->store().FindHand("claw"));
}

// ---- Import -----------------------------------------------------------------

TEST_F(ServiceTest, AnImportedMugHasLabelledParts) {
  const auto service = MakeService(Copy("imported"));
  const auto imported = service->ImportObject(MakeNovelOrder(), context_);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_TRUE(imported->created);
  ASSERT_THAT(imported->parts, SizeIs(2));
  EXPECT_EQ(imported->parts[0].label, "body");
  EXPECT_THAT(imported->parts[0].adjacent, ElementsAre("handle"));
  EXPECT_EQ(imported->object.format, "obj");
  EXPECT_EQ(imported->object.units, "m");
  EXPECT_EQ(imported->object.segmentation.verdict, "matched");
  EXPECT_EQ(imported->object.segmentation.example_id, FindExample(*service));
  // The bundled labels are the oracle: nearly every face is right.
  const auto truth = FaceLabelsFromJson(
      ReadFileBytes(kData + "/mug/latte.labels.json").value());
  const auto meshes =
      service->store().ReadObjectMeshes(imported->object.id).value();
  ASSERT_EQ(meshes.canonical_labels.size(), truth->size());
  double right = 0.0;
  for (size_t f = 0; f < truth->size(); ++f) {
    const bool same =
        (meshes.canonical_labels[f] == 0) == (truth->at(f) == "body");
    if (same) right += meshes.canonical.area(static_cast<int>(f));
  }
  EXPECT_GT(right, 0.95 * meshes.canonical.total_area());
}

TEST_F(ServiceTest, TheSameImportTwiceIsOneObject) {
  const auto service = MakeService(Copy("imported"));
  const auto first = service->ImportObject(MakeNovelOrder(), context_).value();
  const auto second = service->ImportObject(MakeNovelOrder(), context_).value();
  EXPECT_FALSE(second.created);
  EXPECT_EQ(second.object.id, first.object.id);
  EXPECT_THAT(second.parts, SizeIs(2));
}

TEST_F(ServiceTest, AutoFindsTheCategory) {
  const auto service = MakeService(Copy("imported"));
  ImportOrder order = MakeNovelOrder();
  order.category = "auto";
  EXPECT_EQ(service->ImportObject(order, context_).value().object.category,
            "mug");
}

TEST_F(ServiceTest, AnObjectOfNoCategoryHasNoParts) {
  const auto service = MakeService(Copy("imported"));
  ImportOrder order;
  order.bytes = MakeBoxFile(0.1);
  order.format = "obj";
  const auto imported = service->ImportObject(order, context_);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_THAT(imported->parts, IsEmpty());
  EXPECT_NEAR(imported->object.mass.volume, 1e-3, 1e-9);
}

TEST_F(ServiceTest, ImportsThatCannotBeSayWhyAndStoreNothing) {
  const auto service = MakeService(Copy("imported"));
  const auto before = service->store().Count().value();
  const auto error_of = [&](const std::function<void(ImportOrder&)>& change) {
    ImportOrder order = MakeNovelOrder();
    change(order);
    const auto imported = service->ImportObject(order, context_);
    return imported ? Error{} : imported.error();
  };
  const Error category = error_of([](auto& o) { o.category = "cup"; });
  EXPECT_EQ(category.code, ErrorCode::kNotFound);
  EXPECT_THAT(category.hint, HasSubstr("mug"));
  EXPECT_EQ(error_of([](auto& o) { o.units = "ell"; }).field, "units");
  EXPECT_EQ(error_of([](auto& o) { o.format = "doc"; }).code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(error_of([](auto& o) { o.bytes = ""; }).code,
            ErrorCode::kUnusableInput);
  EXPECT_EQ(error_of([](auto& o) { o.bytes = "no mesh"; }).code,
            ErrorCode::kUnusableInput);
  EXPECT_EQ(error_of([](auto& o) { o.bytes = std::string(5 << 20, 'v'); }).code,
            ErrorCode::kTooLarge);
  // A mug of 94 m, said to be in metres: it was in millimetres.
  EXPECT_EQ(error_of([](auto& o) { o.bytes = MakeBoxFile(94.0); }).code,
            ErrorCode::kUnusableInput);
  EXPECT_EQ(error_of([](auto& o) { o.face_labels = {"body"}; }).field,
            "face_labels");
  EXPECT_EQ(error_of([](auto& o) {
              o.role = ObjectRole::kExample;
              o.category = "";
            }).field,
            "category");
  // A box is no mug, and cannot become an example of one without labels.
  const Error foreign = error_of([](auto& o) {
    o.bytes = MakeBoxFile(0.1);
    o.role = ObjectRole::kExample;
  });
  EXPECT_EQ(foreign.code, ErrorCode::kNotInCategory);
  EXPECT_EQ(service->store().Count().value(), before);
}

TEST_F(ServiceTest, ACategoryWithoutExamplesAsksForOne) {
  const auto service = MakeService(Copy("imported"));
  ASSERT_TRUE(service->AddCategory(
      CategoryFromJson(R"({"name":"box","parts":[{"label":"all"}]})").value()));
  ImportOrder order;
  order.bytes = MakeBoxFile(0.1);
  order.format = "obj";
  order.category = "box";
  const auto refused = service->ImportObject(order, context_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
  EXPECT_THAT(refused.error().hint, HasSubstr("/v1/categories/box/examples"));
  order.role = ObjectRole::kExample;
  order.face_labels = std::vector<std::string>(12, "all");
  EXPECT_TRUE(service->ImportObject(order, context_));
}

// ---- Segmentation -----------------------------------------------------------

TEST_F(ServiceTest, GivenLabelsReplaceTheSegmentation) {
  const auto service = MakeService(Copy("imported"));
  const auto imported =
      service->ImportObject(MakeNovelOrder(), context_).value();
  SegmentOrder order;
  order.object_id = imported.object.id;
  order.face_labels =
      FaceLabelsFromJson(
          ReadFileBytes(kData + "/mug/latte.labels.json").value())
          .value();
  const auto labelled = service->Resegment(order, context_);
  ASSERT_TRUE(labelled) << labelled.error().message;
  EXPECT_EQ(labelled->object.segmentation.method, "labels");
  order.face_labels.back() = "lid";
  const auto unknown = service->Resegment(order, context_);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().hint, "known: body, handle");
  order.face_labels.pop_back();
  EXPECT_EQ(service->Resegment(order, context_).error().field, "face_labels");
}

TEST_F(ServiceTest, AnObjectIsSegmentedAgainWithOtherSettings) {
  const auto service = MakeService(Copy("imported"));
  const auto imported =
      service->ImportObject(MakeNovelOrder(), context_).value();
  SegmentOrder order;
  order.object_id = imported.object.id;
  order.settings = R"({"max_residual":1e-6})";
  const auto strict = service->Resegment(order, context_);
  ASSERT_TRUE(strict) << strict.error().message;
  EXPECT_EQ(strict->object.segmentation.verdict, "foreign");
}

TEST_F(ServiceTest, PartsOfTheSameLabelBecomeOne) {
  const auto service = MakeService(Copy("imported"));
  const auto imported =
      service->ImportObject(MakeNovelOrder(), context_).value();
  const auto merged =
      service->Relabel(imported.parts[1].id, "body", /* cascade = */ false);
  ASSERT_TRUE(merged) << merged.error().message;
  ASSERT_THAT(merged->parts, SizeIs(1));
  EXPECT_EQ(std::ssize(merged->parts[0].faces), imported.object.num_triangles);
  EXPECT_EQ(service->Relabel(merged->parts[0].id, "lid", false).error().field,
            "label");
}

// ---- Learning ---------------------------------------------------------------

TEST_F(ServiceTest, NothingIsLearnedTwice) {
  const auto service = MakeService(Copy("learned"));
  LearnOrder lesson;
  lesson.object_id = FindExample(*service);
  lesson.part_labels = {"body"};
  lesson.parameters = MakeQuickParameters();
  const auto before = service->store().Count().value();
  int stages = 0;
  ExecutionContext context([&](const std::string&, double) { ++stages; });
  const auto known = service->LearnObject(lesson, context);
  ASSERT_TRUE(known);
  EXPECT_THAT(*known, SizeIs(1));
  EXPECT_EQ(stages, 1);  // "learned": nothing else had to be done.
  EXPECT_EQ(service->store().Count().value(), before);
}

TEST_F(ServiceTest, CancelledLearningStoresNothing) {
  const auto service = MakeService(Copy("imported"));
  LearnOrder lesson;
  lesson.object_id = FindExample(*service);
  ExecutionContext* self = nullptr;
  ExecutionContext context([&](const std::string&, double) { self->Cancel(); });
  self = &context;
  const auto cancelled = service->LearnObject(lesson, context);
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().code, ErrorCode::kCancelled);
  EXPECT_EQ(service->store().Count().value().grasp_spaces, 0);
}

TEST_F(ServiceTest, LearningNamesWhatItDoesNotKnow) {
  const auto service = MakeService(Copy("imported"));
  const auto error_of = [&](const std::function<void(LearnOrder&)>& change) {
    LearnOrder order;
    order.object_id = FindExample(*service);
    change(order);
    return service->LearnObject(order, context_).error();
  };
  EXPECT_EQ(error_of([](auto& o) { o.object_id = "x"; }).code,
            ErrorCode::kNotFound);
  EXPECT_EQ(error_of([](auto& o) { o.part_labels = {"lid"}; }).hint,
            "known: body, handle");
  EXPECT_THAT(error_of([](auto& o) { o.hands = {"claw"}; }).hint,
              HasSubstr(kDefaultHand));
  EXPECT_EQ(error_of([](auto& o) { o.parameters.contact.friction = -1; }).field,
            "contact.friction");
}

// ---- Transfer ---------------------------------------------------------------

TEST_F(ServiceTest, BeforeAnythingIsLearnedTheAnswerNamesTheCommand) {
  const auto service = MakeService(Copy("imported"));
  const auto refused = service->TransferGrasps(MakeOrder(), context_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
  EXPECT_THAT(refused.error().hint,
              HasSubstr("graspdb learn " + FindExample(*service)));
}

TEST_F(ServiceTest, ATransferAccountsForEverySourceGrasp) {
  const auto service = MakeService(Copy("learned"));
  const auto answer = service->TransferGrasps(MakeOrder(), context_);
  ASSERT_TRUE(answer) << answer.error().message;
  const StoredTransfer& transfer = answer->transfer;
  EXPECT_THAT(transfer.attempts, SizeIs(4));
  EXPECT_THAT(transfer.part_labels, ElementsAre("body"));
  EXPECT_THAT(transfer.contact_maps, SizeIs(1));
  size_t assembled = 0;
  for (const StoredAttempt& attempt : transfer.attempts) {
    EXPECT_TRUE(service->store().FindGrasp(attempt.source_grasp_id));
    if (attempt.assembled_grasp_id.empty()) continue;
    ++assembled;
    EXPECT_EQ(attempt.assembly, TransferOutcome::kSucceeded);
  }
  ASSERT_THAT(answer->grasps, SizeIs(assembled));
  // Nothing has been simulated.
  const auto merit = [](const StoredGrasp& grasp) {
    return grasp.grip.value_or(0.0) + 0.03 * grasp.grasp.quality.epsilon;
  };
  for (size_t i = 0; i < answer->grasps.size(); ++i) {
    const StoredGrasp& grasp = answer->grasps[i];
    EXPECT_EQ(grasp.stage, GraspStage::kAssembly);
    EXPECT_EQ(grasp.targets_O.size(), grasp.grasp.contacts.size());
    EXPECT_GT(grasp.grasp.quality.epsilon, 0.0);
    if (i > 0) {
      EXPECT_LE(merit(grasp), merit(answer->grasps[i - 1]));
    }
  }
}

TEST_F(ServiceTest, TheSameTransferIsTheSameBytesForAnyThreadsAndFromTheStore) {
  const auto one = MakeService(Copy("learned"), 1);
  const auto two = MakeService(Copy("learned"), 2);
  const std::string first =
      ToJson(one->TransferGrasps(MakeOrder(), context_).value());
  EXPECT_EQ(ToJson(two->TransferGrasps(MakeOrder(), context_).value()), first);
  EXPECT_EQ(ToJson(one->TransferGrasps(MakeOrder(), context_).value()), first);
  EXPECT_EQ(one->store().Count().value().transfers, 1);
  TransferOrder other = MakeOrder();
  other.seed = 2;
  EXPECT_NE(one->TransferGrasps(other, context_).value().transfer.id,
            one->TransferGrasps(MakeOrder(), context_).value().transfer.id);
}

TEST_F(ServiceTest, CountCutsTheAnswerAndNotTheWork) {
  const auto service = MakeService(Copy("learned"));
  TransferOrder order = MakeOrder();
  const auto all = service->TransferGrasps(order, context_).value();
  order.count = 1;
  const auto best = service->TransferGrasps(order, context_).value();
  EXPECT_EQ(best.transfer.id, all.transfer.id);
  ASSERT_LE(best.grasps.size(), 1u);
  if (!all.grasps.empty()) {
    EXPECT_EQ(best.grasps[0].id, all.grasps[0].id);
  }
}

TEST_F(ServiceTest, ATransferTellsEachGraspAsItWillBeStored) {
  const auto service = MakeService(Copy("learned"));
  std::map<std::string, std::string> told;
  const auto hand = service->FindHandModel("barrett-bh8-280").value();
  const auto answer = service
                          ->TransferGrasps(MakeOrder(), context_,
                                           [&](const StoredGrasp& grasp) {
                                             told[grasp.id] =
                                                 ToJson(grasp, *hand);
                                           })
                          .value();
  std::map<std::string, std::string> stored;
  for (const StoredGrasp& grasp : answer.grasps) {
    stored[grasp.id] = ToJson(grasp, *hand);
  }
  EXPECT_THAT(told, Not(IsEmpty()));
  EXPECT_EQ(told, stored);
}

// It was stored as if its deadline had cut it, and answered for ever after.
TEST_F(ServiceTest, ACancelledTransferStoresNothing) {
  const auto service = MakeService(Copy("learned"));
  ExecutionContext* self = nullptr;
  ExecutionContext context([&](const std::string& stage, double) {
    if (stage == "transfer: transferring") self->Cancel();
  });
  self = &context;
  TransferOrder order = MakeOrder();
  order.sources = 12;
  const auto before = service->store().Count().value();
  EXPECT_EQ(service->TransferGrasps(order, context).error().code,
            ErrorCode::kCancelled);
  const auto after = service->store().Count().value();
  EXPECT_EQ(after.transfers, before.transfers);
  EXPECT_EQ(after.grasps, before.grasps);
}

TEST_F(ServiceTest, PartsThatNothingIsLearnedForAreWarnedOf) {
  const auto service = MakeService(Copy("learned"));
  TransferOrder order = MakeOrder();
  order.part_labels = {};
  const auto answer = service->TransferGrasps(order, context_);
  ASSERT_TRUE(answer);
  EXPECT_THAT(answer->transfer.warnings,
              ElementsAre("nothing is learned for the handle"));
  order.part_labels = {"handle"};
  EXPECT_EQ(service->TransferGrasps(order, context_).error().code,
            ErrorCode::kConflict);
}

TEST_F(ServiceTest, ATransferNamesWhatItDoesNotKnow) {
  const auto service = MakeService(Copy("learned"));
  const auto error_of = [&](const std::function<void(TransferOrder&)>& change) {
    TransferOrder order = MakeOrder();
    change(order);
    const auto answer = service->TransferGrasps(order, context_);
    return answer ? Error{} : answer.error();
  };
  EXPECT_EQ(error_of([](auto& o) { o.part_labels = {"lid"}; }).code,
            ErrorCode::kNotFound);
  EXPECT_EQ(error_of([](auto& o) { o.hand = "claw"; }).code,
            ErrorCode::kNotFound);
  EXPECT_EQ(error_of([](auto& o) {
              o.part_labels = {};
              o.task = "juggle";
            }).hint,
            "known: handover, use");
  EXPECT_EQ(error_of([](auto& o) { o.task = "use"; }).field, "task");
  EXPECT_EQ(error_of([](auto& o) { o.count = 0; }).field, "count");
  EXPECT_EQ(error_of([](auto& o) { o.sources = 0; }).field, "sources");
  EXPECT_EQ(error_of([](auto& o) { o.category = ""; }).field, "category");
  EXPECT_EQ(
      error_of([](auto& o) { o.parameters.contact.friction = -0.5; }).field,
      "contact.friction");
}

TEST_F(ServiceTest, AForeignObjectIsKeptButGetsNoGrasps) {
  const auto service = MakeService(Copy("learned"));
  TransferOrder order = MakeOrder();
  order.mesh.bytes = MakeBoxFile(0.1);
  const auto before = service->store().Count().value();
  const auto refused = service->TransferGrasps(order, context_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kNotInCategory);
  EXPECT_EQ(service->store().Count().value().objects, before.objects + 1);
}

TEST_F(ServiceTest, AStoredObjectNeedsNoMesh) {
  const auto service = MakeService(Copy("learned"));
  TransferOrder order = MakeOrder();
  const auto by_mesh = service->TransferGrasps(order, context_).value();
  order.mesh = {};
  order.category = "";
  order.object_id = by_mesh.object.id;
  EXPECT_EQ(service->TransferGrasps(order, context_).value().transfer.id,
            by_mesh.transfer.id);
}

TEST_F(ServiceTest, GraspsAreFoundByTask) {
  const auto service = MakeService(Copy("learned"));
  GraspSearch search;
  search.task = "use";
  EXPECT_EQ(service->QueryGrasps(search).error().field, "category");
  search.query.category = "mug";
  EXPECT_THAT(service->QueryGrasps(search).value().items, Not(IsEmpty()));
  search.task = "juggle";
  EXPECT_THAT(service->QueryGrasps(search).value().items, IsEmpty());
  search.query.category = "cup";
  EXPECT_EQ(service->QueryGrasps(search).error().code, ErrorCode::kNotFound);
}

// ---- Jobs -------------------------------------------------------------------

TEST_F(ServiceTest, ATransferJobEndsWithItsTransfer) {
  const auto service = MakeService(Copy("learned"));
  ASSERT_TRUE(service->StartWorkers());
  const auto queued = service->SubmitTransfer(MakeOrder()).value();
  const auto done = service->WaitForJob(queued.id, kLongEnough).value();
  ASSERT_EQ(done.state, JobState::kSucceeded)
      << done.error.value_or(Error{}).message;
  EXPECT_EQ(done.progress, 1.0);
  EXPECT_TRUE(service->DescribeTransfer(done.result_id, std::nullopt));
}

TEST_F(ServiceTest, AJobOnABadMeshFailsAndStoresNothing) {
  const auto service = MakeService(Copy("learned"));
  std::vector<StoredJob> ended;
  JobObserver observer;
  observer.on_end = [&](const StoredJob& job, double) { ended.push_back(job); };
  ASSERT_TRUE(service->StartWorkers(observer));
  TransferOrder order = MakeOrder();
  order.mesh.bytes = "v nothing";
  const auto before = service->store().Count().value();
  const auto queued = service->SubmitTransfer(order).value();
  const auto done = service->WaitForJob(queued.id, kLongEnough).value();
  EXPECT_EQ(done.state, JobState::kFailed);
  EXPECT_EQ(done.error.value().code, ErrorCode::kUnusableInput);
  EXPECT_EQ(service->store().Count().value(), before);
  service->StopWorkers();
  ASSERT_THAT(ended, SizeIs(1));  // Whoever runs the server is told.
  EXPECT_EQ(ended[0].id, queued.id);
  EXPECT_EQ(ended[0].error, done.error);
}

TEST_F(ServiceTest, WhatCanBeCheckedAtOnceIsRefusedBeforeAJobIsMade) {
  const auto service = MakeService(Copy("imported"));
  EXPECT_FALSE(service->SubmitTransfer(MakeOrder()));  // Nothing is learned.
  ImportOrder import = MakeNovelOrder();
  import.category = "cup";
  EXPECT_FALSE(service->SubmitImport(import));
  import = MakeNovelOrder();
  import.face_labels = {"body", "lid"};
  const auto unknown = service->SubmitImport(import);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().field, "face_labels");
  EXPECT_THAT(unknown.error().hint, HasSubstr("handle"));
  LearnOrder lesson;
  lesson.object_id = "x";
  EXPECT_FALSE(service->SubmitLearn(lesson));
  EXPECT_THAT(service->ListJobs(std::nullopt, {}).value().items, IsEmpty());
}

TEST_F(ServiceTest, ACancelledJobStopsSoonAndStoresNothing) {
  const auto service = MakeService(Copy("imported"));
  ASSERT_TRUE(service->StartWorkers());
  LearnOrder lesson;
  lesson.object_id = FindExample(*service);
  const auto first = service->SubmitLearn(lesson).value();
  const auto second = service->SubmitLearn(lesson).value();
  StoredJob seen = first;
  while (seen.state == JobState::kQueued) {
    seen = service->WaitForChange(seen, kLongEnough).value();
  }
  EXPECT_EQ(service->CancelJob(second.id).value().state, JobState::kCancelled);
  ASSERT_TRUE(service->CancelJob(first.id));
  EXPECT_EQ(service->WaitForJob(first.id, kLongEnough).value().state,
            JobState::kCancelled);
  EXPECT_EQ(service->CancelJob(first.id).value().state, JobState::kCancelled);
  EXPECT_EQ(service->store().Count().value().grasp_spaces, 0);
}

TEST_F(ServiceTest, ATransferThatItsDeadlineCutAnswersNoOtherRequest) {
  const auto service = MakeService(Copy("learned"));
  ExecutionContext hasty;
  TransferOrder order = MakeOrder();
  order.sources = 8;
  // One thread, so that nobody reads the deadline while it is set.
  const auto alone = MakeService(service->store().path(), 1);
  const auto cut =
      alone
          ->TransferGrasps(
              order, hasty,
              [&](const StoredGrasp&) {
                hasty.set_deadline(ExecutionContext::Clock::time_point{});
              })
          .value()
          .transfer;
  EXPECT_FALSE(cut.complete);
  EXPECT_THAT(cut.warnings, Contains(HasSubstr("deadline")));
  EXPECT_LT(cut.attempts.size(), 8u);

  // Nothing at all in no time.
  ExecutionContext late;
  late.set_deadline(ExecutionContext::Clock::time_point{});
  EXPECT_EQ(service->TransferGrasps(order, late).error().code,
            ErrorCode::kDeadlineExceeded);
  EXPECT_TRUE(service->store().FindTransfer(cut.id));

  const auto whole = service->TransferGrasps(order, context_).value().transfer;
  EXPECT_TRUE(whole.complete);
  EXPECT_THAT(whole.attempts, SizeIs(8));
  EXPECT_NE(whole.id, cut.id);
  EXPECT_EQ(whole.id, cut.inputs_id);
  // Of the same inputs only the whole one stays.
  EXPECT_FALSE(service->store().FindTransfer(cut.id));

  // In time it is the same as without.
  ExecutionContext patient;
  patient.set_deadline(ExecutionContext::Clock::now() + kLongEnough);
  EXPECT_EQ(service->TransferGrasps(order, patient).value().transfer.id,
            whole.id);
}

TEST_F(ServiceTest, AJobThatMissesItsDeadlineFailsAndStoresNothing) {
  const auto service = MakeService(Copy("imported"));
  LearnOrder lesson;
  lesson.object_id = FindExample(*service);
  const auto queued = service->SubmitLearn(lesson, {.deadline = 0.1}).value();
  EXPECT_TRUE(queued.deadline);
  // Nobody works on it: who waits is told all the same.
  const auto missed = service->WaitForJob(queued.id, kLongEnough).value();
  ASSERT_EQ(missed.state, JobState::kFailed);
  EXPECT_EQ(missed.error.value().code, ErrorCode::kDeadlineExceeded);

  std::mutex mutex;
  std::vector<std::string> ended;
  JobObserver observer;
  observer.on_end = [&](const StoredJob& job, double) {
    const std::lock_guard lock(mutex);
    ended.push_back(job.id);
  };
  ASSERT_TRUE(service->StartWorkers(observer));
  const auto begun = service->SubmitLearn(lesson, {.deadline = 0.5}).value();
  const auto behind = service->SubmitLearn(lesson, {.deadline = 0.1}).value();
  for (const auto& id : {begun.id, behind.id}) {
    const auto done = service->WaitForJob(id, kLongEnough).value();
    ASSERT_EQ(done.state, JobState::kFailed);
    EXPECT_EQ(done.error.value().code, ErrorCode::kDeadlineExceeded);
  }
  service->StopWorkers();
  // Whoever runs the server is told of each, once.
  EXPECT_THAT(ended, UnorderedElementsAre(begun.id, behind.id));
  EXPECT_EQ(service->store().Count().value().grasp_spaces, 0);
}

TEST_F(ServiceTest, OfAJobThatKilledThreeServersTheNextOneTells) {
  const auto service = MakeService(Copy("imported"));
  LearnOrder lesson;
  lesson.object_id = FindExample(*service);
  const auto fatal = service->SubmitLearn(lesson, {}).value();
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(service->store().RequeueRunningJobs(true));
    ASSERT_TRUE(service->store().ClaimJob(true).value());
  }
  std::vector<StoredJob> ended;
  JobObserver observer;
  observer.on_end = [&](const StoredJob& job, double) { ended.push_back(job); };
  ASSERT_TRUE(service->StartWorkers(observer));
  service->StopWorkers();
  ASSERT_THAT(ended, SizeIs(1));
  EXPECT_EQ(ended[0].id, fatal.id);
  EXPECT_EQ(ended[0].error.value().code, ErrorCode::kInternal);
}

// While there is one no file of this process can be written to.
class FullDisk {
 public:
  FullDisk() {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit none = before_;
    none.rlim_cur = 0;
    setrlimit(RLIMIT_FSIZE, &none);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

TEST_F(ServiceTest, AFullDiskDoesNotHideThatAJobMissedItsDeadline) {
  const auto service = MakeService(Copy("imported"));
  LearnOrder lesson;
  lesson.object_id = FindExample(*service);
  const auto queued = service->SubmitLearn(lesson, {.deadline = 0.1}).value();
  {
    const FullDisk full;
    const auto missed = service->WaitForJob(queued.id, kLongEnough).value();
    EXPECT_EQ(missed.state, JobState::kFailed);
    EXPECT_EQ(missed.error.value().code, ErrorCode::kDeadlineExceeded);
    EXPECT_EQ(service->store().FindJob(queued.id).value().state,
              JobState::kQueued);
  }
  EXPECT_EQ(service->FindJob(queued.id).value().state, JobState::kFailed);
  EXPECT_EQ(service->store().FindJob(queued.id).value().state,
            JobState::kFailed);
}

TEST_F(ServiceTest, HowAJobEndedIsWrittenOnceTheDiskHasRoom) {
  const auto service = MakeService(Copy("imported"));
  ASSERT_TRUE(service->StartWorkers());
  LearnOrder lesson;
  lesson.object_id = FindExample(*service);
  const auto job = service->SubmitLearn(lesson).value();
  while (service->FindJob(job.id).value().stage.empty()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  {
    const FullDisk full;
    ASSERT_TRUE(service->CancelJob(job.id));
    std::this_thread::sleep_for(std::chrono::seconds(1));
    EXPECT_EQ(service->FindJob(job.id).value().state, JobState::kRunning);
  }
  EXPECT_EQ(service->WaitForJob(job.id, kLongEnough).value().state,
            JobState::kCancelled);
}

TEST_F(ServiceTest, SegmentingAgainIsAJob) {
  const auto service = MakeService(Copy("imported"));
  ASSERT_TRUE(service->StartWorkers());
  const auto object =
      service->ImportObject(MakeNovelOrder(), context_).value().object;
  SegmentOrder order;
  order.object_id = object.id;
  order.settings = R"({"pairwise_weight": 0.5})";
  order.seed = 7;
  const auto queued = service->SubmitSegment(order).value();
  const auto done = service->WaitForJob(queued.id, kLongEnough).value();
  ASSERT_EQ(done.state, JobState::kSucceeded);
  EXPECT_EQ(done.result_id, object.id);
  const auto segmented = service->store().FindObject(object.id).value();
  EXPECT_EQ(segmented.segmentation.method, "transfer");
  order.face_labels.assign(static_cast<size_t>(object.num_triangles), "body");
  const auto labelled = service->SubmitSegment(order).value();
  ASSERT_EQ(service->WaitForJob(labelled.id, kLongEnough).value().state,
            JobState::kSucceeded);
  EXPECT_THAT(service->store().ListParts(object.id).value(), SizeIs(1));
  order.face_labels[0] = "lid";
  const auto wrong = service->SubmitSegment(order).value();
  const auto failed = service->WaitForJob(wrong.id, kLongEnough).value();
  ASSERT_EQ(failed.state, JobState::kFailed);
  EXPECT_EQ(failed.error.value().field, "face_labels");
  order.face_labels = {"body"};
  EXPECT_EQ(service->SubmitSegment(order).error().field, "face_labels");
  order.category = "cup";
  EXPECT_EQ(service->SubmitSegment(order).error().code, ErrorCode::kNotFound);
  order.object_id = "x";
  EXPECT_EQ(service->SubmitSegment(order).error().code, ErrorCode::kNotFound);
}

TEST_F(ServiceTest, VerificationIsAJob) {
  const auto service = MakeService(Copy("learned"));
  ASSERT_TRUE(service->StartWorkers());
  VerifyOrder order;
  order.query.category = "mug";
  order.query.stage = GraspStage::kLearned;
  order.limit = 2;
  const auto queued = service->SubmitVerify(order).value();
  const auto done = service->WaitForJob(queued.id, kLongEnough).value();
  ASSERT_EQ(done.state, JobState::kSucceeded)
      << done.error.value_or(Error{}).message;
  GraspSearch search;
  search.query = order.query;
  const auto grasps = service->QueryGrasps(search).value().items;
  EXPECT_EQ(std::count_if(grasps.begin(), grasps.end(),
                          [](const StoredGrasp& grasp) {
                            return grasp.physical.has_value();
                          }),
            2);
  order.query.category = "cup";
  EXPECT_EQ(service->SubmitVerify(order).error().code, ErrorCode::kNotFound);
}

TEST_F(ServiceTest, AJobThatTheServersEndInterruptedIsDoneByTheNext) {
  const std::string db = Copy("learned");
  std::string id;
  {
    const auto service = MakeService(db);
    ASSERT_TRUE(service->StartWorkers());
    TransferOrder order = MakeOrder();
    order.sources = 12;
    order.seed = 3;
    StoredJob seen = service->SubmitTransfer(order).value();
    id = seen.id;
    while (seen.state == JobState::kQueued) {
      seen = service->WaitForChange(seen, kLongEnough).value();
    }
    service->StopWorkers();
    service->StopWorkers();
    const auto left = service->FindJob(id).value();
    EXPECT_TRUE(left.state == JobState::kQueued ||
                left.state == JobState::kSucceeded);
  }
  const auto next = MakeService(db);
  ASSERT_TRUE(next->StartWorkers());
  EXPECT_EQ(next->WaitForJob(id, kLongEnough).value().state,
            JobState::kSucceeded);
}

TEST_F(ServiceTest, OneServerAtATimeWorksOnADatabasesJobs) {
  const std::string db = Copy("learned");
  const auto first = MakeService(db);
  const auto second = MakeService(db);
  ASSERT_TRUE(first->StartWorkers());
  const auto refused = second->StartWorkers();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
  first->StopWorkers();
  EXPECT_TRUE(second->StartWorkers());
}

TEST_F(ServiceTest, TransfersAndImportsDoNotWaitForLearning) {
  const auto service = MakeService(Copy("learned"));
  ASSERT_TRUE(service->StartWorkers());
  LearnOrder lesson;
  lesson.object_id = FindExample(*service);
  const auto learning = service->SubmitLearn(lesson).value();
  const auto transfer = service->SubmitTransfer(MakeOrder()).value();
  EXPECT_EQ(service->WaitForJob(transfer.id, kLongEnough).value().state,
            JobState::kSucceeded);
  ImportOrder import = MakeNovelOrder("bowl");
  import.role = ObjectRole::kExample;
  import.learn = false;
  const auto imported = service->SubmitImport(import).value();
  EXPECT_EQ(service->WaitForJob(imported.id, kLongEnough).value().state,
            JobState::kSucceeded);
  EXPECT_FALSE(service->FindJob(learning.id).value().Finished());
}

TEST_F(ServiceTest, WaitingEndsWithTheTimeout) {
  const auto service = MakeService(Copy("learned"));
  const auto queued = service->SubmitTransfer(MakeOrder()).value();
  EXPECT_EQ(service->WaitForJob(queued.id, milliseconds(20)).value().state,
            JobState::kQueued);
  EXPECT_EQ(service->WaitForJob("x", milliseconds(20)).error().code,
            ErrorCode::kNotFound);
}

}  // namespace
}  // namespace graspdb
