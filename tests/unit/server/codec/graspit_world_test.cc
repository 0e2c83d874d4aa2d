#include "server/codec/graspit_world.h"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace graspdb {
namespace {

using testing::HasSubstr;

// A finger of two joints, the outer at a third of the inner until it breaks
// away, beside a spread joint.
HandModel MakeHand() {
  HandModel::Data data;
  data.name = std::string("claw");
  data.links.resize(4);
  for (int i = 0; i < 3; ++i) {
    HandJoint joint;
    joint.child_link = i + 1;
    joint.upper = 2.0;
    joint.actuator = i == 0 ? 0 : 1;
    data.joints.push_back(joint);
    HandLink& link = data.links[static_cast<size_t>(i) + 1];
    link.parent = 0;
    link.joint = i;
  }
  data.joints[2].ratio = 1.0 / 3.0;
  data.joints[2].breakaway_ratio = 4.0 / 3.0;
  data.actuators = {{"spread", {0}, false, 0.0, 2.0},
                    {"f1", {1, 2}, true, 0.0, 2.0}};
  return HandModel(std::move(data));
}

StoredGrasp MakeGrasp(const Eigen::Vector3d& q) {
  StoredGrasp grasp;
  grasp.id = std::string("g");
  grasp.hand = std::string("claw");
  grasp.object_id = std::string("o");
  grasp.grasp.configuration = {{Eigen::Matrix3d::Identity(), {0.1, 0, 0}}, q};
  return grasp;
}

const GraspitModel kModel{
    "models/robots/A&B.xml",
    {Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ())
         .toRotationMatrix(),
     {0, 0, 0.05}}};

TEST(GraspsToGraspit, WritesMillimetresAndTheQuaternionsRealPartFirst) {
  const StoredGrasp grasp = MakeGrasp({0.5, 0.9, 0.3});
  const std::string world = GraspsToGraspit({&grasp}, MakeHand(), kModel);
  EXPECT_THAT(world, HasSubstr("<filename>models/objects/o.xml</filename>"));
  EXPECT_THAT(world, HasSubstr("(1 0 0 0)[0 0 0]"));
  EXPECT_THAT(world, HasSubstr("models/robots/A&amp;B.xml"));
  EXPECT_THAT(world, HasSubstr(" 0 0 1)[100 0 50]"));
}

TEST(GraspsToGraspit, TellsAFingerThatBrokeAway) {
  const StoredGrasp coupled = MakeGrasp({0.5, 0.75, 0.25});
  const StoredGrasp broken = MakeGrasp({0.5, 0.75, 0.5});
  EXPECT_THAT(GraspsToGraspit({&coupled}, MakeHand(), kModel),
              HasSubstr("<dofValues>0.5 0.75 0 0</dofValues>"));
  EXPECT_THAT(GraspsToGraspit({&broken}, MakeHand(), kModel),
              HasSubstr("<dofValues>0.5 1.5 1 0.75 0</dofValues>"));
}

TEST(GraspsToGraspit, NamesEachObjectOnceAndEachGrasp) {
  const StoredGrasp a = MakeGrasp({0, 0, 0});
  StoredGrasp b = a;
  StoredGrasp c = a;
  c.object_id = std::string("p");
  const std::string world = GraspsToGraspit({&a, &b, &c}, MakeHand(), kModel);
  const auto count = [&](const std::string& what) {
    int found = 0;
    for (size_t at = 0; (at = world.find(what, at)) != std::string::npos;
         ++at) {
      ++found;
    }
    return found;
  };
  EXPECT_EQ(count("<graspableBody>"), 2);
  EXPECT_EQ(count("<robot>"), 3);
}

}  // namespace
}  // namespace graspdb
