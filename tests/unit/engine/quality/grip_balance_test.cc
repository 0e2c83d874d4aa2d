#include "engine/quality/grip_balance.h"

#include <gtest/gtest.h>

#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// Two jaws pinch a box of 40 mm along x at points around its mass centre.
//
//        z |  jaw 1 → [ box ] ← jaw 2
//          +---- x
class PinchedBox : public ::testing::Test {
 protected:
  double Calc() const { return Calc(hand_); }
  double Calc(const HandShape& hand) const {
    const HandModel& model = hand.model();
    return CalcGripResidual(
        hand, RigidTransform(),
        CalcLinkPoses(model, Eigen::VectorXd::Zero(model.num_joints())),
        contacts_, mass_, cones_, grip_, motors_);
  }

  const HandShape hand_{workshop::MakeTwoJawGripper()};
  const MassProperties mass_ =
      CalcMassProperties(workshop::MakeBox({0.04, 0.04, 0.04}));
  // Links 1 and 2 are the jaws; four points a side bear torques, too.
  std::vector<Contact> contacts_ = [] {
    std::vector<Contact> contacts;
    for (const double y : {-0.01, 0.01}) {
      for (const double z : {-0.01, 0.01}) {
        contacts.push_back({1, {-0.02, y, z}, {-1, 0, 0}, 0.0});
        contacts.push_back({2, {0.02, y, z}, {1, 0, 0}, 0.0});
      }
    }
    return contacts;
  }();
  ContactParameters cones_;
  GripParameters grip_;
  MotorParameters motors_;
};

TEST_F(PinchedBox, IsHeldByTheStandardForces) { EXPECT_EQ(Calc(), 0.0); }

TEST_F(PinchedBox, IsHeldAsWellByAJawThatMimicsBackwards) {
  const HandShape backwards(workshop::TurnRound(hand_.model(), {1}));
  EXPECT_EQ(Calc(backwards), 0.0);
  motors_.closing_force = 0.2;
  motors_.holding_force = 0.2;
  EXPECT_GT(Calc(backwards), 0.1);
  EXPECT_NEAR(Calc(backwards), Calc(), 1e-9);
}

// Friction 0.5 · 0.8 on two sides carries 0.8 F across. A push of 1 N along the
// jaws needs nothing of friction.
TEST_F(PinchedBox, SlipsWhereCoulombSays) {
  grip_.least_force = 0.1;
  motors_.closing_force = 0.2;
  motors_.holding_force = 1.0 / 0.8 + 0.01;
  EXPECT_EQ(Calc(), 0.0);
  motors_.holding_force = 1.0 / 0.8 - 0.05;
  EXPECT_GT(Calc(), 0.0);
  // The jaws' friction is short of all but 0.8 · 0.2 N of the push; the least
  // squares share the rest between object and jaws.
  motors_.holding_force = 0.2;
  EXPECT_GT(Calc(), 0.5);
  EXPECT_LT(Calc(), 1.0 - 0.8 * 0.2 + 1e-9);
}

TEST_F(PinchedBox, IsNotHeldFromOneSideHoweverTheFingersPress) {
  std::erase_if(contacts_, [](const Contact& c) { return c.link == 2; });
  EXPECT_GT(Calc(), grip_.least_force / 2.0);
}

TEST_F(PinchedBox, ABaseBearsWhateverItIsPressedWith) {
  // The base takes the place of one jaw.
  for (Contact& contact : contacts_) {
    if (contact.link == 2) contact.link = 0;
  }
  EXPECT_EQ(Calc(), 0.0);
}

TEST_F(PinchedBox, TurnedWithTheHandTheSameIsLeft) {
  motors_.holding_force = motors_.closing_force = grip_.least_force + 0.01;
  grip_.push = 3.0;
  // A quarter turn about x maps the six pushes onto themselves.
  const RigidTransform X(
      {Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix(),
       {0.3, -0.2, 0.1}});
  const double before = Calc();
  EXPECT_GT(before, 0.1);
  for (Contact& contact : contacts_) {
    contact.p_O = X * contact.p_O;
    contact.nhat_O = X.rotation * contact.nhat_O;
  }
  MassProperties mass = mass_;
  mass.p_McCM = X * mass_.p_McCM;
  const HandModel& model = hand_.model();
  // Not exactly: the cones' edges turn.
  EXPECT_NEAR(
      CalcGripResidual(
          hand_, X,
          CalcLinkPoses(model, Eigen::VectorXd::Zero(model.num_joints())),
          contacts_, mass, cones_, grip_, motors_),
      before, 0.1 * before);
}

TEST_F(PinchedBox, OfFewerThanTwoContactsNothingIsHeld) {
  contacts_.resize(1);
  EXPECT_GE(Calc(), 1.0);
}

}  // namespace
}  // namespace graspdb
