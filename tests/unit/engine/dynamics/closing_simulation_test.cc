#include "engine/dynamics/closing_simulation.h"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/workshop.h"

namespace graspdb {
namespace {

constexpr double kFriction = 0.5;

// Two jaws pinch a box along x with 5 N each; it floats between them.
class Pinch : public testing::Test {
 protected:
  ClosingOutcome Run(const HoldParameters& parameters,
                     double friction = kFriction,
                     const Eigen::Vector3d& shift_H = {0, 0, 0},
                     double q_open = 0.0) const {
    return ClosingSimulation(gripper_, box_, parameters, MotorParameters())
        .Run({Eigen::Matrix3d::Identity(),
              Eigen::Vector3d(0, 0, -0.07) + shift_H},
             Eigen::Vector2d::Constant(q_open), friction);
  }

  const HandShape gripper_{workshop::MakeTwoJawGripper()};
  const Solid box_{workshop::MakeBox({0.04, 0.03, 0.05}, 2)};
};

TEST_F(Pinch, BetweenTheJawsTheBoxStaysWhereItIs) {
  const ClosingOutcome outcome = Run(HoldParameters());
  EXPECT_TRUE(outcome.settled);
  EXPECT_TRUE(outcome.held);
  EXPECT_LT(outcome.shift, 1e-4);
  EXPECT_LT(outcome.turn, 1e-3);
}

TEST_F(Pinch, TheJawThatComesFirstPushesTheBoxIntoTheMiddle) {
  const ClosingOutcome outcome =
      Run(HoldParameters(), kFriction, {0.004, 0, 0});
  EXPECT_TRUE(outcome.settled);
  EXPECT_NEAR(outcome.shift, 0.004, 0.0005);
  // What is pushed farther than an object may move is lost.
  HoldParameters strict;
  strict.max_shift = 0.003;
  EXPECT_FALSE(Run(strict, kFriction, {0.004, 0, 0}).settled);
}

TEST_F(Pinch, SlipsWhereCoulombSaysWithinThirtyPercent) {
  for (const double friction : {0.5, 0.2}) {
    HoldParameters parameters;
    parameters.push_seconds = 1.0;
    const double limit = 2.0 * friction * MotorParameters().closing_force;
    parameters.push = 0.7 * limit;
    EXPECT_TRUE(Run(parameters, friction).held) << friction;
    parameters.push = 1.3 * limit;
    const ClosingOutcome outcome = Run(parameters, friction);
    EXPECT_TRUE(outcome.settled) << friction;
    EXPECT_FALSE(outcome.held) << friction;
  }
}

TEST_F(Pinch, WhatNothingTouchesIsNotHeld) {
  const ClosingOutcome outcome = Run(HoldParameters(), kFriction, {0, 0, -0.2});
  EXPECT_FALSE(outcome.settled);
  EXPECT_FALSE(outcome.held);
}

TEST_F(Pinch, SettlesTheSameEachTimeAndAlikeAtHalfTheStep) {
  const ClosingOutcome first =
      Run(HoldParameters(), kFriction, {0.002, 0.001, 0});
  const ClosingOutcome second =
      Run(HoldParameters(), kFriction, {0.002, 0.001, 0});
  EXPECT_EQ(first.shift, second.shift);
  EXPECT_EQ(first.turn, second.turn);
  HoldParameters fine;
  fine.time_step = 0.5 * HoldParameters().time_step;
  EXPECT_NEAR(Run(fine, kFriction, {0.002, 0.001, 0}).shift, first.shift,
              0.0003);
}

TEST_F(Pinch, HowFarTheJawsComeFromDoesNotMatter) {
  const ClosingOutcome far =
      Run(HoldParameters(), kFriction, {0.004, 0.001, 0});
  const ClosingOutcome near =
      Run(HoldParameters(), kFriction, {0.004, 0.001, 0}, 0.01);
  EXPECT_TRUE(far.held);
  EXPECT_NEAR(far.shift, near.shift, 1e-4);
  EXPECT_NEAR(far.turn, near.turn, 1e-3);
}

TEST_F(Pinch, AJawThatMimicsBackwardsHoldsAsItDoesForwards) {
  const HandShape backwards(workshop::TurnRound(gripper_.model(), {1}));
  const Eigen::Vector3d shift_H(0.004, 0.001, 0);
  const ClosingOutcome turned =
      ClosingSimulation(backwards, box_, HoldParameters(), MotorParameters())
          .Run({Eigen::Matrix3d::Identity(),
                Eigen::Vector3d(0, 0, -0.07) + shift_H},
               Eigen::Vector2d::Zero(), kFriction);
  const ClosingOutcome forwards = Run(HoldParameters(), kFriction, shift_H);
  EXPECT_TRUE(turned.held);
  EXPECT_NEAR(turned.shift, forwards.shift, 1e-9);
  EXPECT_NEAR(turned.turn, forwards.turn, 1e-9);
}

// The Barrett hand around a cylinder that stands along z.
class BarrettGrasp : public testing::Test {
 protected:
  // @param gap  Between palm and cylinder, m.
  ClosingOutcome Run(double gap, double friction) const {
    constexpr double kPalm = 0.0793;
    constexpr double kRadius = 0.035;
    const Solid cylinder(workshop::MakeCylinder(kRadius, 0.16, 32, 4));
    const Eigen::Matrix3d R_OH =
        Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY())
            .toRotationMatrix();
    const HandModel& model = hand_.model();
    Eigen::VectorXd motors = Eigen::VectorXd::Zero(model.num_actuators());
    for (int a = 0; a < model.num_actuators(); ++a) {
      if (model.actuators()[static_cast<size_t>(a)].closes) motors[a] = 0.5;
    }
    HoldParameters parameters;
    parameters.push = 1.0;
    return ClosingSimulation(hand_, cylinder, parameters, MotorParameters())
        .Run({R_OH, -(kPalm + kRadius + gap) * R_OH.col(2)},
             model.CalcCoupledJoints(motors), friction);
  }

  const HandShape hand_{workshop::LoadBarrettHand()};
};

TEST_F(BarrettGrasp, HoldsACylinderAgainstThePalm) {
  EXPECT_TRUE(Run(0.0004, kFriction).held);
}

TEST_F(BarrettGrasp, WithoutFrictionTheCylinderSlidesOut) {
  EXPECT_FALSE(Run(0.0004, 0.01).held);
}

TEST_F(BarrettGrasp, HoldsNothingFromAfar) {
  EXPECT_FALSE(Run(0.2, kFriction).held);
}

}  // namespace
}  // namespace graspdb
