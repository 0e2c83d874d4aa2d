#include "engine/simulation/grasp_simulator.h"

#include <numbers>

#include <gtest/gtest.h>

#include "engine/hand/finger_closing.h"
#include "engine/hand/hand_shape.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// Two jaws pinch a box along x with 5 N each.
class Pinch : public testing::Test {
 protected:
  PhysicalVerdict Judge(const PushTest& test) const {
    Grasp grasp;
    grasp.q_pregrasp = Eigen::VectorXd::Zero(gripper_->num_joints());
    grasp.configuration = {X_OH_, grasp.q_pregrasp};
    return GraspSimulator(gripper_, box_, test).Judge(grasp);
  }

  // Along y and z, where friction alone holds the box.
  static bool HeldAcross(const PhysicalVerdict& verdict) {
    return verdict.settled && verdict.held[2] && verdict.held[3] &&
           verdict.held[4] && verdict.held[5];
  }
  static bool LostAcross(const PhysicalVerdict& verdict) {
    return verdict.settled && !verdict.held[2] && !verdict.held[3] &&
           !verdict.held[4] && !verdict.held[5];
  }

  const std::shared_ptr<const HandModel> gripper_ =
      workshop::MakeTwoJawGripper();
  const TriangleMesh box_ = workshop::MakeBox({0.04, 0.03, 0.05}, 2);
  const RigidTransform X_OH_{Eigen::Matrix3d::Identity(), {0, 0, -0.07}};
};

TEST_F(Pinch, SlipsWhereCoulombSaysWithinThirtyPercent) {
  for (const double friction : {0.5, 0.2, 0.05}) {
    PushTest test;
    test.friction = friction;
    const double limit = 2.0 * friction * test.closing_force;
    test.force = 0.7 * limit;
    EXPECT_TRUE(HeldAcross(Judge(test))) << friction;
    test.force = 1.3 * limit;
    EXPECT_TRUE(LostAcross(Judge(test))) << friction;
  }
}

TEST_F(Pinch, HoldsTheStandardPushesButNotWithoutFriction) {
  EXPECT_EQ(Judge(PushTest()).CalcScore(), 1.0);
  PushTest slippery;
  slippery.friction = 0.05;
  EXPECT_LT(Judge(slippery).CalcScore(), 0.5);
}

TEST_F(Pinch, ForceAlongTheJawsIsStoodByTheGears) {
  PushTest test;
  test.force = 10.0;  // More than the 5 N of closing, less than 15 N.
  const PhysicalVerdict verdict = Judge(test);
  EXPECT_TRUE(verdict.held[0] && verdict.held[1]);
}

TEST_F(Pinch, LiftsHalfAKiloButNotTwo) {
  PushTest lift = MakeLiftTest();
  // 4.9 N of weight against 2 · 0.5 · 5 N of friction: just held.
  lift.closing_force = 7.0;
  EXPECT_EQ(Judge(lift).CalcScore(), 1.0);
  lift.mass = 2.0;
  lift.force = 2.0 * 9.81;
  EXPECT_EQ(Judge(lift).CalcScore(), 0.0);
}

TEST_F(Pinch, AtFrictionThreeTheNetDisplacementIsSmallEvenWhenItSlips) {
  const PhysicalVerdict verdict = Judge(MakeNetDisplacementTest());
  EXPECT_EQ(verdict.held.size(), 1u);
  EXPECT_EQ(verdict.CalcScore(), 1.0);
  PushTest strong = MakeNetDisplacementTest();
  strong.friction = 0.05;
  strong.force = 5.0;  // Ten times what friction bears.
  EXPECT_EQ(Judge(strong).CalcScore(), 0.0);
}

TEST_F(Pinch, AJawThatMimicsBackwardsHoldsAsItDoesForwards) {
  Grasp grasp;
  grasp.q_pregrasp = Eigen::VectorXd::Zero(gripper_->num_joints());
  grasp.configuration = {X_OH_, grasp.q_pregrasp};
  const PhysicalVerdict turned =
      GraspSimulator(workshop::TurnRound(*gripper_, {1}), box_, PushTest())
          .Judge(grasp);
  EXPECT_EQ(turned.CalcScore(), 1.0);
  EXPECT_EQ(turned.held, Judge(PushTest()).held);
}

TEST_F(Pinch, GivesTheSameVerdictEachTime) {
  EXPECT_EQ(Judge(PushTest()), Judge(PushTest()));
}

// The Barrett hand around a cylinder, sphere or mug, the palm against it.
class BarrettGrasp : public testing::Test {
 protected:
  // @param R_OH  z_H points from the hand to the object's centre.
  Grasp Close(const TriangleMesh& mesh, const Eigen::Matrix3d& R_OH,
              const Eigen::Vector3d& centre, double radius) const {
    constexpr double kPalm = 0.0793;
    constexpr double kGap = 0.0004;  // The palm counts as touching.
    Grasp grasp;
    Eigen::VectorXd motors = Eigen::VectorXd::Zero(hand_->num_actuators());
    for (int a = 0; a < hand_->num_actuators(); ++a) {
      if (hand_->actuators()[static_cast<size_t>(a)].closes) motors[a] = 0.5;
    }
    grasp.q_pregrasp = hand_->CalcCoupledJoints(motors);
    grasp.configuration.X_OH = {R_OH,
                                centre - (kPalm + radius + kGap) * R_OH.col(2)};
    grasp.configuration.q =
        CloseFingers(HandShape(hand_), grasp.configuration.X_OH,
                     grasp.q_pregrasp, Solid(mesh));
    return grasp;
  }

  PhysicalVerdict Judge(const TriangleMesh& mesh, const Grasp& grasp) const {
    return GraspSimulator(hand_, mesh, PushTest()).Judge(grasp);
  }

  // z_H along x, y_H along y: the fingers reach around what stands along z.
  const Eigen::Matrix3d R_OH_ =
      Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY())
          .toRotationMatrix();
  const std::shared_ptr<const HandModel> hand_ = workshop::LoadBarrettHand();
};

TEST_F(BarrettGrasp, HoldsACylinderASphereAndAMug) {
  const TriangleMesh cylinder = workshop::MakeCylinder(0.035, 0.16, 32, 4);
  EXPECT_EQ(
      Judge(cylinder, Close(cylinder, R_OH_, Eigen::Vector3d::Zero(), 0.035))
          .CalcScore(),
      1.0);
  const TriangleMesh sphere = workshop::MakeSphere(0.04, 12);
  EXPECT_EQ(Judge(sphere, Close(sphere, R_OH_, Eigen::Vector3d::Zero(), 0.04))
                .CalcScore(),
            1.0);
  const TriangleMesh mug = workshop::LoadMug("classic").mesh_O;
  const Eigen::Vector3d middle(0.0, 0.0, 0.5 * mug.box_max().z());
  EXPECT_EQ(Judge(mug, Close(mug, R_OH_, middle, 0.0408)).CalcScore(), 1.0);
}

TEST_F(BarrettGrasp, HoldsNothingFromAfar) {
  const TriangleMesh sphere = workshop::MakeSphere(0.04, 12);
  Grasp grasp = Close(sphere, R_OH_, Eigen::Vector3d::Zero(), 0.04);
  grasp.configuration.X_OH.translation.x() -= 0.2;
  EXPECT_LT(Judge(sphere, grasp).CalcScore(), 0.2);
}

TEST_F(BarrettGrasp, LosesTheSphereWithoutTheFingerThatOpposes) {
  const TriangleMesh sphere = workshop::MakeSphere(0.04, 12);
  Grasp grasp = Close(sphere, R_OH_, Eigen::Vector3d::Zero(), 0.04);
  EXPECT_EQ(Judge(sphere, grasp).CalcScore(), 1.0);
  HandModel::Data data;
  data.name = "two fingers";
  data.links = hand_->links();
  data.joints = hand_->joints();
  data.actuators = hand_->actuators();
  data.contact_points = hand_->contact_points();
  for (HandLink& link : data.links) {
    if (link.name.starts_with("bh_finger_3")) link.pieces_L.clear();
  }
  const auto two = std::make_shared<const HandModel>(std::move(data));
  EXPECT_LT(GraspSimulator(two, sphere, PushTest()).Judge(grasp).CalcScore(),
            0.9);
}

TEST(PhysicalVerdict, ScoresTheShareOfPushesWithstood) {
  PhysicalVerdict verdict;
  verdict.held = {true, true, false, true, false, false};
  EXPECT_EQ(verdict.CalcScore(), 0.0);
  verdict.settled = true;
  EXPECT_EQ(verdict.CalcScore(), 0.5);
}

}  // namespace
}  // namespace graspdb
