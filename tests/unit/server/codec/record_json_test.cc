#include "server/codec/record_json.h"

#include <gmock/gmock.h>

#include "server/codec/json.h"
#include "tests/support/stored_records.h"

namespace graspdb {
namespace {

// A base and two sliding jaws, each with its own motor.
HandModel MakeGripper() {
  HandModel::Data data;
  data.name = "claw";
  data.links.resize(3);
  data.links[0].name = "palm";
  for (int i = 1; i <= 2; ++i) {
    data.links[i].name = "jaw_" + std::to_string(i);
    data.links[i].joint = i - 1;
    data.links[i].parent = 0;
    HandJoint joint;
    joint.name = "slide_" + std::to_string(i);
    joint.type = JointType::kPrismatic;
    joint.child_link = i;
    joint.upper = 0.05;
    joint.actuator = i - 1;
    data.joints.push_back(joint);
    HandActuator actuator;
    actuator.name = "motor_" + std::to_string(i);
    actuator.joints = {i - 1};
    actuator.closes = true;
    actuator.upper = 0.05;
    data.actuators.push_back(actuator);
  }
  return HandModel(data);
}

StoredGrasp MakeStoredGrasp() {
  StoredGrasp grasp;
  grasp.id = "g1";
  grasp.stage = GraspStage::kAssembly;
  grasp.object_id = "o1";
  grasp.part_id = "p1";
  grasp.part_label = "handle";
  grasp.category = "mug";
  grasp.hand = "claw";
  // A quarter turn about z, 0.1 m along x.
  grasp.grasp.configuration.X_OH.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  grasp.grasp.configuration.X_OH.translation = {0.1, 0.0, 0.0};
  grasp.grasp.configuration.q = Eigen::Vector2d(0.01, 0.02);
  grasp.grasp.q_pregrasp = Eigen::Vector2d(0.0, 0.0);
  grasp.grasp.approach_O = {0.0, 0.0, -1.0};
  grasp.grasp.retreat = 0.25;
  grasp.grasp.contacts = {{1, {0.1, 0.2, 0.3}, {1.0, 0.0, 0.0}, 1e-4},
                          {2, {0.1, 0.0, 0.3}, {-1.0, 0.0, 0.0}, 1e-4}};
  grasp.grasp.quality = {0.21, 0.03, 12.1};
  grasp.targets_O = {Eigen::Vector3d(0.1, 0.2, 0.31), std::nullopt};
  grasp.example_epsilon = 0.18;
  grasp.open_close_epsilon = 0.09;
  grasp.robust = 0.97;
  grasp.grasp_space_id = "s1";
  grasp.transfer_id = "t1";
  grasp.source_grasp_id = "g0";
  grasp.engine_version = "0.1.0";
  grasp.parameters_hash = "h";
  grasp.seed = 18446744073709551615u;
  return grasp;
}

// The whole contract of one grasp, by hand: api.md's example. A quarter turn
// about z is the quaternion (0, 0, 1, 1)/sqrt 2; the pre-grasp is 0.25 m
// against the approach (0, 0, -1).
TEST(RecordJson, AGraspHasTheShapeOfTheContract) {
  const Json json = ParseJson(ToJson(MakeStoredGrasp(), MakeGripper())).value();
  const double half = std::sqrt(0.5);
  EXPECT_EQ(json["id"], "g1");
  EXPECT_EQ(json["part"], "handle");
  EXPECT_EQ(json["stage"], "assembly");
  EXPECT_EQ(json["X_OH"]["position"], Json::array({0.1, 0.0, 0.0}));
  EXPECT_DOUBLE_EQ(json["X_OH"]["orientation"]["x"].get<double>(), 0.0);
  EXPECT_DOUBLE_EQ(json["X_OH"]["orientation"]["z"].get<double>(), half);
  EXPECT_DOUBLE_EQ(json["X_OH"]["orientation"]["w"].get<double>(), half);
  EXPECT_EQ(json["joints"], Json::parse(R"({"slide_1":0.01,"slide_2":0.02})"));
  EXPECT_EQ(json["actuators"],
            Json::parse(R"({"motor_1":0.01,"motor_2":0.02})"));
  EXPECT_EQ(json["pregrasp"]["X_OH"]["position"],
            Json::array({0.1, 0.0, 0.25}));
  EXPECT_EQ(json["pregrasp"]["approach"], Json::array({0.0, 0.0, -1.0}));
  EXPECT_EQ(json["pregrasp"]["distance"], 0.25);
  EXPECT_EQ(json["quality"]["epsilon"], 0.21);
  EXPECT_EQ(json["quality"]["open_close_epsilon"], 0.09);
  EXPECT_TRUE(json["quality"]["physical"].is_null());
  EXPECT_EQ(json["contacts"][0]["link"], "jaw_1");
  EXPECT_EQ(json["contacts"][0]["mapped_p_O"], Json::array({0.1, 0.2, 0.31}));
  EXPECT_TRUE(json["contacts"][1]["mapped_p_O"].is_null());
  EXPECT_EQ(json["provenance"]["seed"], 18446744073709551615u);
  EXPECT_EQ(json["provenance"]["source_grasp"], "g0");
}

TEST(RecordJson, EveryRotationComesBackFromItsQuaternion) {
  Random random(1);
  const HandModel hand = MakeGripper();
  for (int round = 0; round < 500; ++round) {
    StoredGrasp grasp = MakeStoredGrasp();
    grasp.grasp.configuration.X_OH = MakePose(random);
    const Json json = ParseJson(ToJson(grasp, hand)).value();
    const Json& q = json["X_OH"]["orientation"];
    const Eigen::Quaterniond quaternion(
        q["w"].get<double>(), q["x"].get<double>(), q["y"].get<double>(),
        q["z"].get<double>());
    EXPECT_NEAR(quaternion.norm(), 1.0, 1e-12);
    EXPECT_GE(quaternion.w(), 0.0);
    EXPECT_LT((quaternion.toRotationMatrix() -
               grasp.grasp.configuration.X_OH.rotation)
                  .norm(),
              1e-12);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(json["X_OH"]["position"][static_cast<size_t>(i)].get<double>(),
                grasp.grasp.configuration.X_OH.translation[i]);
    }
  }
}

TEST(RecordJson, AnAnswerCountsWhatHappenedAndSaysWhy) {
  TransferAnswer answer;
  answer.hand = std::make_shared<const HandModel>(MakeGripper());
  answer.grasps = {MakeStoredGrasp()};
  answer.transfer.id = "t1";
  answer.transfer.seconds = {{"transfer", 1.0}};
  StoredAttempt kept;
  kept.source_grasp_id = "g0";
  kept.transfer = kept.assembly = TransferOutcome::kSucceeded;
  kept.open_close_epsilon_whole = 0.1;
  StoredAttempt collided = kept;
  collided.source_grasp_id = "g2";
  collided.assembly = TransferOutcome::kPalmCollision;
  collided.open_close_epsilon_whole = 0.0;
  StoredAttempt lost = collided;
  lost.source_grasp_id = "g3";
  lost.transfer = TransferOutcome::kUnstable;
  answer.transfer.attempts = {kept, collided, lost};
  const Json json = ParseJson(ToJson(answer)).value();
  EXPECT_EQ(json["summary"],
            Json::parse(R"({"attempted":3,"transferred":2,"assembled":1,)"
                        R"("baseline_open_close":1})"));
  ASSERT_EQ(json["rejected"].size(), 2u);
  EXPECT_EQ(json["rejected"][0]["source_grasp"], "g2");
  EXPECT_EQ(json["rejected"][0]["stage"], "assembly");
  EXPECT_EQ(json["rejected"][0]["reason"], "palm_collision");
  EXPECT_EQ(json["rejected"][1]["stage"], "transfer");
  EXPECT_EQ(json["rejected"][1]["reason"], "unstable");
  EXPECT_EQ(json["grasps"].size(), 1u);
  EXPECT_FALSE(json.contains("seconds"));  // Times are not reproducible.
}

TEST(RecordJson, ListsEndWithNull) {
  EXPECT_EQ(ListToJson({}, ""), R"({"items":[],"next_cursor":null})");
  EXPECT_EQ(ListToJson({"{}", "1"}, "a\""),
            R"({"items":[{},1],"next_cursor":"a\""})");
}

TEST(RecordJson, JobsTellTheirResultOrTheirErrorButNoInternals) {
  StoredJob job;
  job.id = "j";
  job.state = JobState::kSucceeded;
  job.result_id = "t1";
  Json json = ParseJson(ToJson(job)).value();
  EXPECT_EQ(json["result"]["transfer"], "t1");
  EXPECT_EQ(json["result"]["href"], "/v1/transfers/t1");
  EXPECT_TRUE(json["error"].is_null());
  EXPECT_TRUE(json["eta_s"].is_null());
  job.state = JobState::kFailed;
  job.error = Error{ErrorCode::kInternal, "/home/secret.cc:12"};
  json = ParseJson(ToJson(job)).value();
  EXPECT_EQ(json["error"]["detail"], "The server made a mistake.");
  job.error = Error{ErrorCode::kUnusableInput, "no mesh", "send one", "mesh"};
  json = ParseJson(ToJson(job)).value();
  EXPECT_EQ(json["error"]["code"], "unusable_input");
  EXPECT_EQ(json["error"]["hint"], "send one");
}

TEST(RecordJson, ObjectsTellUnknownThingsAsNull) {
  NewObject object = MakeNewObject("a", ObjectRole::kNovel);
  object.record.category.clear();
  object.record.segmentation = {};
  const Json bare = ParseJson(ToJson(object.record)).value();
  EXPECT_TRUE(bare["category"].is_null());
  EXPECT_TRUE(bare["segmentation"].is_null());
  EXPECT_FALSE(bare.contains("parts"));
  const NewObject full = MakeNewObject("a", ObjectRole::kNovel);
  const Json json = ParseJson(ToJson(full.record, full.parts)).value();
  EXPECT_EQ(json["parts"][1]["num_faces"], 6);
  EXPECT_FALSE(json["parts"][1].contains("faces"));
  EXPECT_TRUE(json["segmentation"]["alignment"].is_null());
  EXPECT_EQ(ParseJson(ToJson(full.parts[1])).value()["faces"].size(), 6u);
}

}  // namespace
}  // namespace graspdb
