#include "engine/quality/contact_extraction.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/hand/finger_closing.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// The gripper looks down on a 40 mm box from above; its jaws meet both sides.
class TwoJawsOnABox : public ::testing::Test {
 protected:
  const HandShape hand_{workshop::MakeTwoJawGripper()};
  const Solid box_{workshop::MakeBox({0.04, 0.04, 0.04}, 4)};
  const RigidTransform X_OH_{
      Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix(),
      {0, 0, 0.07}};
};

TEST_F(TwoJawsOnABox, JawsCloseUntilTheyTouch) {
  const Eigen::VectorXd q =
      CloseFingers(hand_, X_OH_, Eigen::Vector2d::Zero(), box_);
  // Each jaw's face travels from 40 mm to the box's side at 20 mm.
  EXPECT_NEAR(q[0], 0.02, 3e-4);
  EXPECT_NEAR(q[1], 0.02, 3e-4);
  EXPECT_LT(q[0], 0.02);
}

TEST_F(TwoJawsOnABox, ContactsAreTheCornersOfTheTouchingPatches) {
  const Eigen::VectorXd q =
      CloseFingers(hand_, X_OH_, Eigen::Vector2d::Zero(), box_);
  const auto contacts =
      ExtractContacts(hand_, X_OH_, CalcLinkPoses(hand_.model(), q), box_, {});
  // Jaws are 20 mm wide and reach from z = 0.05 down to -0.01; the box's top is
  // at 0.02: a patch of 20 x 30 mm on each side, four corners each.
  ASSERT_EQ(contacts.size(), 8u);
  for (const Contact& c : contacts) {
    EXPECT_NEAR(std::abs(c.p_O.x()), 0.02, 1e-9);
    EXPECT_NEAR(std::abs(c.p_O.y()), 0.01, 0.002);
    EXPECT_TRUE(std::abs(c.p_O.z() - 0.02) < 0.002 ||
                std::abs(c.p_O.z() + 0.01) < 0.002)
        << c.p_O.transpose();
    EXPECT_NEAR(c.nhat_O.x(), c.p_O.x() > 0 ? 1.0 : -1.0, 0.3);
    EXPECT_LE(c.gap, 3e-4);
  }
}

TEST_F(TwoJawsOnABox, CapsAreNotTouched) {
  // The box again, all of it a cap.
  const Solid caps(workshop::MakeBox({0.04, 0.04, 0.04}, 4), 0);
  const Eigen::VectorXd q =
      CloseFingers(hand_, X_OH_, Eigen::Vector2d::Zero(), caps);
  EXPECT_TRUE(
      ExtractContacts(hand_, X_OH_, CalcLinkPoses(hand_.model(), q), caps, {})
          .empty());
}

}  // namespace
}  // namespace graspdb
