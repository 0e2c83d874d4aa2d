#include "engine/render/grasp_scene.h"

#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/engine/render/render_scenes.h"

namespace graspdb {
namespace {

using Eigen::Vector3d;

// A base and one finger that turns about H's z, 0.1 m out along x; each link is
// a cube of 0.02 m.
HandModel MakeOneFinger() {
  HandModel::Data data;
  data.name = "one-finger";
  const TriangleMesh cube = MakeBox(Vector3d::Zero(), Vector3d::Constant(0.01));
  data.links.resize(2);
  data.links[0].name = "base";
  data.links[0].pieces_L = {cube};
  data.links[1].name = "finger";
  data.links[1].joint = 0;
  data.links[1].parent = 0;
  data.links[1].pieces_L = {
      CalcTransformed(cube, {Eigen::Matrix3d::Identity(), {0.1, 0, 0}})};
  HandJoint joint;
  joint.name = "joint";
  joint.child_link = 1;
  joint.upper = 3;
  joint.actuator = 0;
  data.joints = {joint};
  HandActuator actuator;
  actuator.name = "motor";
  actuator.joints = {0};
  actuator.closes = true;
  actuator.upper = 3;
  data.actuators = {actuator};
  return HandModel(std::move(data));
}

Vector3d Middle(const TriangleMesh& mesh) {
  return (mesh.box_min() + mesh.box_max()) / 2;
}

TriangleMesh UnitBox() { return MakeBox(Vector3d::Zero(), Vector3d::Ones()); }

TEST(GraspScene, PartsHaveDifferentColours) {
  std::set<std::tuple<float, float, float>> colours;
  for (int label = 0; label < 7; ++label) {
    const Rgb c = PartColour(label);
    colours.insert({c.r, c.g, c.b});
  }
  EXPECT_EQ(colours.size(), 7U);
  EXPECT_EQ(PartColour(7), PartColour(0));
}

TEST(GraspScene, ColoursEachFaceByItsLabel) {
  std::vector<int> labels(12, 0);
  labels[5] = 1;
  const std::vector<RenderItem> items = MakeGraspScene(UnitBox(), labels, {});
  ASSERT_EQ(items.size(), 1U);
  ASSERT_EQ(items[0].colours.size(), 12U);
  EXPECT_EQ(items[0].colours[4], PartColour(0));
  EXPECT_EQ(items[0].colours[5], PartColour(1));
}

TEST(GraspScene, AnObjectWithoutLabelsHasOneColour) {
  const std::vector<RenderItem> items = MakeGraspScene(UnitBox(), {}, {});
  ASSERT_EQ(items.size(), 1U);
  EXPECT_EQ(items[0].colours, std::vector<Rgb>{PartColour(0)});
}

TEST(GraspScene, PosesEachLinkByItsJoint) {
  const HandModel hand = MakeOneFinger();
  PosedHand posed;
  posed.hand = &hand;
  // H is turned by 90 degrees about z and moved to (1, 2, 3); the finger points
  // along H's x turned by another 90 degrees: along -x of O.
  posed.configuration.X_OH.rotation =
      Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ())
          .toRotationMatrix();
  posed.configuration.X_OH.translation = Vector3d(1, 2, 3);
  posed.configuration.q = Eigen::VectorXd::Constant(1, std::numbers::pi / 2);
  const std::vector<RenderItem> items = MakeGraspScene(UnitBox(), {}, {posed});
  ASSERT_EQ(items.size(), 3U);
  EXPECT_TRUE(Middle(items[1].mesh_O).isApprox(Vector3d(1, 2, 3), 1e-12));
  EXPECT_TRUE(Middle(items[2].mesh_O).isApprox(Vector3d(0.9, 2, 3), 1e-12));
}

TEST(GraspScene, ThePalmIsDarkerThanTheFingers) {
  const HandModel hand = MakeOneFinger();
  PosedHand posed;
  posed.hand = &hand;
  posed.configuration.q = Eigen::VectorXd::Zero(1);
  const std::vector<RenderItem> items = MakeGraspScene(UnitBox(), {}, {posed});
  ASSERT_EQ(items.size(), 3U);
  EXPECT_LT(items[1].colours[0].g, items[2].colours[0].g - 0.2F);
}

TEST(GraspScene, ContactsAreClosedSpheresAtTheirPlaces) {
  const HandModel hand = MakeOneFinger();
  PosedHand posed;
  posed.hand = &hand;
  posed.configuration.q = Eigen::VectorXd::Zero(1);
  posed.contacts_O = {Vector3d(0.1, 0.2, 0.3)};
  const std::vector<RenderItem> items = MakeGraspScene(UnitBox(), {}, {posed});
  ASSERT_EQ(items.size(), 4U);
  const TriangleMesh& sphere = items[3].mesh_O;
  EXPECT_TRUE(IsClosed(sphere));
  const MassProperties mass = CalcMassProperties(sphere);
  EXPECT_TRUE(mass.p_McCM.isApprox(posed.contacts_O[0], 1e-9));
  // Outward, and a sphere of 2.8 mm (92 nl) less what 12 x 8 facets cut off.
  EXPECT_GT(mass.volume, 0.75 * 9.2e-8);
  EXPECT_LT(mass.volume, 9.2e-8);
}

TEST(GraspScene, TurnsToSeeTheHandFromTheSide) {
  View view;
  view.azimuth = 0;
  view.elevation = 0;
  PosedHand posed;
  posed.approach_O = Vector3d::UnitX();  // Along the default line of sight.
  const View turned = TurnTowards(UnitBox(), posed, view);
  EXPECT_NEAR(CalcCameraDirection(turned).dot(posed.approach_O), 0, 1e-12);
}

TEST(GraspScene, TurnsToSeeTheHeldPlaceFromTheSide) {
  View view;
  view.azimuth = 0;
  view.elevation = 0;
  PosedHand posed;
  posed.approach_O = -Vector3d::UnitZ();
  posed.contacts_O = {Vector3d(1.2, 0.1, 0), Vector3d(1.2, -0.1, 0)};
  const View turned = TurnTowards(UnitBox(), posed, view);
  EXPECT_NEAR(CalcCameraDirection(turned).x(), 0, 1e-12);
}

TEST(GraspScene, KeepsTheViewThatIsGoodAlready) {
  View view;
  PosedHand posed;
  posed.approach_O = -Vector3d::UnitZ();
  posed.contacts_O = {Vector3d(1, 0, 0), Vector3d(-1, 0, 0)};
  EXPECT_EQ(TurnTowards(UnitBox(), posed, view).azimuth, view.azimuth);
}

TEST(GraspScene, ASheetHasOneCellPerGrasp) {
  const HandModel hand = MakeOneFinger();
  const TriangleMesh box = UnitBox();
  SheetCell cell;
  cell.mesh_O = &box;
  cell.hand.hand = &hand;
  cell.hand.configuration.q = Eigen::VectorXd::Zero(1);
  View view;
  view.width = 40;
  view.height = 30;
  view.antialiasing = 1;
  const Image sheet =
      RenderContactSheet({cell, cell, cell, cell, cell}, 3, view);
  EXPECT_EQ(sheet.width, 120);
  EXPECT_EQ(sheet.height, 60);
  // Equal cells look the same wherever they stand; the sixth is left white.
  EXPECT_EQ(PixelAt(sheet, 20, 15), PixelAt(sheet, 60, 45));
  EXPECT_THAT(PixelAt(sheet, 100, 45), testing::ElementsAre(255, 255, 255));
}

TEST(GraspScene, TheCaptionIsWrittenIntoItsCell) {
  const HandModel hand = MakeOneFinger();
  const TriangleMesh box = UnitBox();
  SheetCell cell;
  cell.mesh_O = &box;
  cell.hand.hand = &hand;
  cell.hand.configuration.q = Eigen::VectorXd::Zero(1);
  SheetCell captioned = cell;
  captioned.caption = "1";
  View view;
  view.width = 60;
  view.height = 45;
  view.antialiasing = 1;
  const Image sheet = RenderContactSheet({cell, captioned}, 2, view);
  int different = 0;
  for (int y = 0; y < 45; ++y) {
    for (int x = 0; x < 60; ++x) {
      different += PixelAt(sheet, x, y) != PixelAt(sheet, 60 + x, y);
    }
  }
  EXPECT_EQ(different, 8);  // The pixels of the glyph "1".
}

}  // namespace
}  // namespace graspdb
