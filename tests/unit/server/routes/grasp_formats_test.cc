#include "server/codec/grasp_formats.h"

#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace graspdb {
namespace {

/** A base and two fingers; the second joint's name needs quotes in CSV. */
std::shared_ptr<const HandModel> MakeHand() {
  HandModel::Data data;
  data.name = "claw";
  data.closing_force = 12.0;
  data.links.resize(3);
  data.joints.resize(2);
  for (size_t i = 0; i < 2; ++i) {
    data.links[i + 1].joint = static_cast<int>(i);
    data.links[i + 1].parent = 0;
    data.joints[i].child_link = static_cast<int>(i) + 1;
  }
  data.joints[0].name = "j1";
  data.joints[1].name = "j,2";
  return std::make_shared<const HandModel>(data);
}

StoredGrasp MakeGrasp() {
  StoredGrasp grasp;
  grasp.id = "g1";
  grasp.object_id = "o1";
  grasp.part_label = "the \"body\"";
  grasp.hand = "claw";
  grasp.stage = GraspStage::kAssembly;
  grasp.grasp.configuration.X_OH.translation = {0.1, -0.25, 0.0};
  // A half turn about z is the quaternion (0, 0, 1, 0).
  grasp.grasp.configuration.X_OH.rotation =
      Eigen::Vector3d(-1.0, -1.0, 1.0).asDiagonal();
  grasp.grasp.configuration.q = Eigen::Vector2d(0.5, 1.0);
  grasp.grasp.q_pregrasp = Eigen::Vector2d(0.0, 0.25);
  grasp.grasp.approach_O = {0.0, 0.0, -1.0};
  grasp.grasp.retreat = 0.1;
  grasp.grasp.quality.epsilon = 0.125;
  return grasp;
}

TEST(GraspsToCsv, HasOneLinePerGraspAndOneColumnPerJoint) {
  const StoredGrasp grasp = MakeGrasp();
  EXPECT_EQ(GraspsToCsv({{&grasp, MakeHand()}}),
            "id,object,part,hand,stage,epsilon,x,y,z,qx,qy,qz,qw,"
            "approach_x,approach_y,approach_z,retreat,j1,\"j,2\"\r\n"
            "g1,o1,\"the \"\"body\"\"\",claw,assembly,0.125,0.1,-0.25,0,"
            "0,0,1,0,0,0,-1,0.1,0.5,1\r\n");
}

TEST(GraspsToCsv, NoGraspsAreAHeaderLine) {
  EXPECT_EQ(GraspsToCsv({}),
            "id,object,part,hand,stage,epsilon,x,y,z,qx,qy,qz,qw,"
            "approach_x,approach_y,approach_z,retreat\r\n");
}

TEST(GraspsToRos, AreMoveItGrasps) {
  const StoredGrasp grasp = MakeGrasp();
  const auto list = nlohmann::json::parse(GraspsToRos({{&grasp, MakeHand()}}));
  ASSERT_EQ(list.size(), 1);
  const auto& message = list[0];
  EXPECT_EQ(message["id"], "g1");
  EXPECT_EQ(message["grasp_quality"], 0.125);
  EXPECT_EQ(message["max_contact_force"], 12.0);
  EXPECT_EQ(message["grasp_pose"]["header"]["frame_id"], "object");
  EXPECT_EQ(message["grasp_pose"]["pose"]["position"]["y"], -0.25);
  EXPECT_EQ(message["grasp_pose"]["pose"]["orientation"]["z"], 1.0);
  const auto& closed = message["grasp_posture"];
  EXPECT_EQ(closed["joint_names"], (nlohmann::json{"j1", "j,2"}));
  EXPECT_EQ(closed["points"][0]["positions"], (nlohmann::json{0.5, 1.0}));
  EXPECT_EQ(message["pre_grasp_posture"]["points"][0]["positions"],
            (nlohmann::json{0.0, 0.25}));
  const auto& approach = message["pre_grasp_approach"];
  EXPECT_EQ(approach["direction"]["vector"]["z"], -1.0);
  EXPECT_EQ(approach["desired_distance"], 0.1);
  EXPECT_EQ(message["post_grasp_retreat"]["direction"]["vector"]["z"], 1.0);
}

}  // namespace
}  // namespace graspdb
