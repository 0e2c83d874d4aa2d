#include "engine/hand/hand_maker.h"

#include <limits>

#include <gmock/gmock.h>

#include "engine/hand/urdf_reader.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

using ::testing::HasSubstr;

// A palm, and a jaw that slides on it, with another that trails.
constexpr char kUrdf[] = R"(<robot name="jaws">
  <link name="palm">
    <collision><origin xyz="0 0 -0.01"/>
      <geometry><mesh filename="palm.obj"/></geometry></collision>
  </link>
  <link name="left">
    <inertial><origin xyz="0 0 0.02"/><mass value="0.3"/>
      <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><mesh filename="jaw.obj"/></geometry></collision>
  </link>
  <link name="right">
    <collision><geometry><mesh filename="jaw.obj"/></geometry></collision>
  </link>
  <joint name="slide" type="prismatic">
    <origin xyz="0 0.03 0"/><parent link="palm"/><child link="left"/>
    <axis xyz="0 -2 0"/><limit lower="0" upper="0.05" effort="1" velocity="1"/>
  </joint>
  <joint name="trail" type="revolute">
    <origin rpy="0 0 1.5707963267948966"/><parent link="palm"/>
    <child link="right"/><axis xyz="0 1 0"/>
    <mimic joint="slide" multiplier="20"/>
    <limit lower="0" upper="1" effort="1" velocity="1"/>
  </joint>
</robot>)";

std::string Replace(std::string text, const std::string& from,
                    const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

std::string FindFault(const std::string& urdf) {
  const auto tree = ReadUrdf(urdf);
  if (tree) return "none";
  EXPECT_EQ(tree.error().code, ErrorCode::kUnusableInput);
  return tree.error().message;
}

TEST(Urdf, TellsLinksJointsAndWhatFollowsWhat) {
  const HandTree tree = ReadUrdf(kUrdf).value();
  ASSERT_EQ(tree.links.size(), 3u);
  EXPECT_EQ(tree.links[0].name, "palm");
  EXPECT_EQ(tree.links[0].pieces.at(0).mesh, "palm.obj");
  EXPECT_EQ(tree.links[0].pieces.at(0).X_LM.translation.z(), -0.01);
  const HandTree::Link& left = tree.links[1];
  EXPECT_EQ(left.parent, 0);
  EXPECT_EQ(left.mass, 0.3);
  EXPECT_EQ(left.p_LcCM.z(), 0.02);
  EXPECT_EQ(left.joint.type, JointType::kPrismatic);
  EXPECT_EQ(left.joint.axis_J, -Eigen::Vector3d::UnitY());
  EXPECT_EQ(left.joint.X_PJ.translation.y(), 0.03);
  EXPECT_EQ(left.joint.upper, 0.05);
  EXPECT_EQ(left.joint.mimicked, "");
  const HandTree::Link& right = tree.links[2];
  EXPECT_EQ(right.joint.type, JointType::kRevolute);
  EXPECT_EQ(right.joint.mimicked, "slide");
  EXPECT_EQ(right.joint.ratio, 20.0);
  EXPECT_TRUE((right.joint.X_PJ.rotation * Eigen::Vector3d::UnitX())
                  .isApprox(Eigen::Vector3d::UnitY()));
}

TEST(Urdf, OfWhatIsNoHandNamesTheFault) {
  EXPECT_THAT(FindFault("<robot"), HasSubstr("cannot be read"));
  EXPECT_THAT(FindFault(Replace(kUrdf, "prismatic", "fixed")),
              HasSubstr("joint slide is fixed"));
  EXPECT_THAT(FindFault(Replace(kUrdf, "revolute", "continuous")),
              HasSubstr("joint trail is neither"));
  EXPECT_THAT(FindFault(Replace(kUrdf, "<mesh filename=\"palm.obj\"/>",
                                "<box size=\"1 1 1\"/>")),
              HasSubstr("link palm"));
  EXPECT_THAT(FindFault(Replace(kUrdf, "filename=\"palm.obj\"",
                                "filename=\"palm.obj\" scale=\"2 2 2\"")),
              HasSubstr("scales palm.obj"));
  EXPECT_THAT(FindFault(Replace(kUrdf, "0.05", "0")), HasSubstr("slide"));
  EXPECT_THAT(FindFault(Replace(kUrdf, "0 0.03 0", "0 300 0")),
              HasSubstr("joint slide"));
  EXPECT_THAT(FindFault(Replace(kUrdf, "0 -2 0", "0 0 0")),
              HasSubstr("joint slide has no axis"));
  EXPECT_THAT(FindFault(Replace(kUrdf, "multiplier=\"20\"",
                                "multiplier=\"20\" offset=\"1\"")),
              HasSubstr("joint trail"));
}

TEST(Urdf, IsUtf8Text) {
  EXPECT_THAT(FindFault(std::string(kUrdf) + "\xE1"), HasSubstr("UTF-8"));
  EXPECT_EQ(FindFault(std::string(kUrdf) + "<!-- \xC3\xA9 -->"), "none");
}

TEST(HandTreeCheck, RefusesWhatNoUrdfReaderMakes) {
  const HandTree good = ReadUrdf(kUrdf).value();
  EXPECT_TRUE(CheckHandTree(good));
  const auto spoil = [&](const auto& change) {
    HandTree tree = good;
    change(tree);
    return !CheckHandTree(tree);
  };
  EXPECT_TRUE(spoil([](HandTree& t) { t.links.clear(); }));
  EXPECT_TRUE(spoil([](HandTree& t) { t.links.resize(65, t.links[1]); }));
  EXPECT_TRUE(spoil([](HandTree& t) { t.links[2].parent = 2; }));
  EXPECT_TRUE(spoil([](HandTree& t) { t.links[1].parent = -1; }));
  EXPECT_TRUE(spoil([](HandTree& t) { t.links[0].parent = 0; }));
  EXPECT_TRUE(spoil([](HandTree& t) { t.links[2].name = "left"; }));
  EXPECT_TRUE(spoil([](HandTree& t) { t.links[2].joint.name = "slide"; }));
  EXPECT_TRUE(spoil([](HandTree& t) { t.links[2].joint.X_PJ.rotation *= -1; }));
  EXPECT_TRUE(spoil([](HandTree& t) { t.links[1].mass = -1.0; }));
  EXPECT_TRUE(spoil([](HandTree& t) { t.links[2].joint.ratio = 0.0; }));
  EXPECT_TRUE(spoil([](HandTree& t) {
    t.links[1].joint.upper = std::numeric_limits<double>::quiet_NaN();
  }));
  EXPECT_TRUE(spoil(
      [](HandTree& t) { t.links[1].pieces.resize(65, t.links[1].pieces[0]); }));
}

class MadeHand : public ::testing::Test {
 protected:
  MadeHand() {
    notes_.name = "jaws";
    notes_.actuators = {{"motor", "slide", true}};
    notes_.contact_points = {
        {"left", Eigen::Vector3d::Zero(), Eigen::Vector3d(0.0, -2.0, 0.0)}};
    notes_.ignored_collisions = {{"palm", "left"}};
  }

  Result<HandModel> Make() const {
    return MakeHand(ReadUrdf(urdf_).value(), notes_,
                    [this](const std::string& name) -> Result<TriangleMesh> {
                      return name == "palm.obj"
                                 ? palm_
                                 : workshop::MakeBox({0.01, 0.01, 0.04});
                    });
  }
  std::string FindFault() const {
    const auto hand = Make();
    return hand ? "none" : hand.error().message;
  }

  std::string urdf_{kUrdf};
  HandAnnotations notes_;
  TriangleMesh palm_{workshop::MakeBox({0.06, 0.06, 0.02})};
};

TEST_F(MadeHand, CouplesWhatMimicsToWhatIsDriven) {
  const HandModel hand = Make().value();
  ASSERT_EQ(hand.num_actuators(), 1);
  EXPECT_EQ(hand.actuators()[0].joints, (std::vector<int>{0, 1}));
  EXPECT_EQ(hand.actuators()[0].upper, 0.05);
  const Eigen::VectorXd q =
      hand.CalcCoupledJoints(Eigen::VectorXd::Constant(1, 0.02));
  EXPECT_NEAR(q[0], 0.02, 1e-15);
  EXPECT_NEAR(q[1], 0.4, 1e-15);
  EXPECT_EQ(hand.contact_points().at(0).nhat_L, -Eigen::Vector3d::UnitY());
  EXPECT_EQ(hand.self_collision_pairs().size(), 2u);
}

TEST_F(MadeHand, NeedsOneActuatorForEachJointAndOneThatCloses) {
  notes_.actuators.push_back({"second", "trail", true});
  EXPECT_THAT(FindFault(), HasSubstr("joint trail has two actuators"));
  notes_.actuators = {{"second", "trail", true}};
  EXPECT_THAT(FindFault(), HasSubstr("joint slide has no actuator"));
  notes_.actuators = {{"motor", "slide", false}};
  EXPECT_THAT(FindFault(), HasSubstr("no actuator closes"));
  notes_.actuators = {{"motor", "slip", true}};
  EXPECT_THAT(FindFault(), HasSubstr("unknown joint slip"));
}

TEST_F(MadeHand, NeedsContactPointsWithDirections) {
  notes_.contact_points[0].nhat_L.setZero();
  EXPECT_THAT(FindFault(), HasSubstr("link left"));
  notes_.contact_points[0].link = "thumb";
  EXPECT_THAT(FindFault(), HasSubstr("no link thumb"));
  notes_.contact_points.clear();
  EXPECT_THAT(FindFault(), HasSubstr("no contact points"));
}

TEST_F(MadeHand, NeedsConvexMeshesOfFewTriangles) {
  palm_ = workshop::LoadMug("latte").mesh_O;
  EXPECT_THAT(FindFault(), HasSubstr("palm.obj is not convex"));
  palm_ = workshop::MakeBox({0.06, 0.06, 0.02}, 32);
  EXPECT_THAT(FindFault(), HasSubstr("5000 triangles"));
}

TEST_F(MadeHand, RefusesABreakawayThatGoesNowhere) {
  notes_.breakaway = {{"slide", "trail", -1.0}};
  EXPECT_THAT(FindFault(), HasSubstr("breakaway of trail"));
}

TEST_F(MadeHand, RefusesABreakawayOfAJointThatMimicsBackwards) {
  urdf_ = Replace(kUrdf, "multiplier=\"20\"", "multiplier=\"-20\"");
  notes_.breakaway = {{"slide", "trail", 1.0}};
  EXPECT_THAT(FindFault(), HasSubstr("mimics backwards"));
}

}  // namespace
}  // namespace graspdb
