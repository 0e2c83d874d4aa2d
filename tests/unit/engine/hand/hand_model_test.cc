#include "engine/hand/hand_model.h"

#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/workshop.h"

namespace graspdb {
namespace {

struct FingerPose {
  Eigen::Vector3d tip;         // Fingertip pad point in W, m.
  Eigen::Vector3d distal;      // Origin of the J3 frame in W, m.
  std::array<double, 4> wxyz;  // Orientation of the distal link in W.
};

struct KinematicsVector {
  double spread;
  std::array<double, 3> j2;
  std::array<double, 3> j3;
  FingerPose fingers[3];
};

// Twelve postures of the Barrett hand computed independently from the published
// kinematic chain, printed to six decimals; the last three after breakaway.
const KinematicsVector kVectors[] = {
    {0.000000,
     {0.000000, 0.000000, 0.000000},
     {0.000000, 0.000000, 0.000000},
     {{{-0.025000, -0.152132, 0.117817},
       {-0.025000, -0.119936, 0.078400},
       {0.500000, 0.500000, -0.500000, -0.500000}},
      {{0.025000, -0.152132, 0.117817},
       {0.025000, -0.119936, 0.078400},
       {0.500000, 0.500000, -0.500000, -0.500000}},
      {{0.000000, 0.152132, 0.117817},
       {0.000000, 0.119936, 0.078400},
       {0.500000, 0.500000, 0.500000, 0.500000}}}},
    {0.000000,
     {0.500000, 0.500000, 0.500000},
     {0.166667, 0.166667, 0.166667},
     {{{-0.025000, -0.110864, 0.162448},
       {-0.025000, -0.109936, 0.111562},
       {0.636076, 0.308881, -0.636076, -0.308881}},
      {{0.025000, -0.110864, 0.162448},
       {0.025000, -0.109936, 0.111562},
       {0.636076, 0.308881, -0.636076, -0.308881}},
      {{0.000000, 0.110864, 0.162448},
       {0.000000, 0.109936, 0.111562},
       {0.308881, 0.636076, 0.308881, 0.636076}}}},
    {0.000000,
     {1.000000, 1.000000, 1.000000},
     {0.333333, 0.333333, 0.333333},
     {{{-0.025000, -0.054525, 0.176435},
       {-0.025000, -0.085262, 0.135870},
       {0.702129, 0.083759, -0.702129, -0.083759}},
      {{0.025000, -0.054525, 0.176435},
       {0.025000, -0.085262, 0.135870},
       {0.702129, 0.083759, -0.702129, -0.083759}},
      {{-0.000000, 0.054525, 0.176435},
       {0.000000, 0.085262, 0.135870},
       {0.083759, 0.702129, 0.083759, 0.702129}}}},
    {0.000000,
     {2.443461, 2.443461, 2.443461},
     {0.814487, 0.814487, 0.814487},
     {{{-0.025000, 0.032904, 0.075168},
       {-0.025000, 0.005502, 0.118056},
       {0.470082, -0.528226, -0.470082, 0.528226}},
      {{0.025000, 0.032904, 0.075168},
       {0.025000, 0.005502, 0.118056},
       {0.470082, -0.528226, -0.470082, 0.528226}},
      {{-0.000000, -0.032904, 0.075168},
       {-0.000000, -0.005502, 0.118056},
       {0.528226, -0.470082, 0.528226, -0.470082}}}},
    {1.570796,
     {0.800000, 0.800000, 0.800000},
     {0.266667, 0.266667, 0.266667},
     {{{-0.102612, -0.000000, 0.174890},
       {-0.121573, -0.000000, 0.127659},
       {0.359498, -0.359498, -0.608902, -0.608902}},
      {{0.102612, 0.000000, 0.174890},
       {0.121573, 0.000000, 0.127659},
       {0.608902, 0.608902, -0.359498, 0.359498}},
      {{-0.000000, 0.077612, 0.174890},
       {0.000000, 0.096573, 0.127659},
       {0.176355, 0.684762, 0.176355, 0.684762}}}},
    {3.141593,
     {0.600000, 0.600000, 0.600000},
     {0.200000, 0.200000, 0.200000},
     {{{-0.025000, 0.100182, 0.167923},
       {-0.025000, 0.106027, 0.117365},
       {0.265821, 0.655240, 0.265821, 0.655240}},
      {{0.025000, 0.100182, 0.167923},
       {0.025000, 0.106027, 0.117365},
       {0.265821, 0.655240, 0.265821, 0.655240}},
      {{0.000000, 0.100182, 0.167923},
       {0.000000, 0.106027, 0.117365},
       {0.265821, 0.655240, 0.265821, 0.655240}}}},
    {1.047198,
     {1.200000, 1.200000, 1.200000},
     {0.400000, 0.400000, 0.400000},
     {{{-0.052891, -0.016103, 0.172701},
       {-0.087826, -0.036273, 0.141670},
       {0.617469, -0.362457, -0.607145, -0.344574}},
      {{0.052891, -0.016103, 0.172701},
       {0.087826, -0.036273, 0.141670},
       {0.607145, 0.344574, -0.617469, 0.362457}},
      {{-0.000000, 0.032206, 0.172701},
       {0.000000, 0.072546, 0.141670},
       {0.010325, -0.707031, 0.010325, -0.707031}}}},
    {0.300000,
     {0.400000, 0.900000, 1.400000},
     {0.133333, 0.300000, 0.466667},
     {{{-0.060738, -0.115530, 0.155709},
       {-0.058467, -0.108189, 0.105398},
       {0.554802, 0.254864, -0.659579, -0.438400}},
      {{0.044519, -0.063101, 0.176338},
       {0.051929, -0.087053, 0.132048},
       {0.706664, 0.232741, -0.667706, -0.025025}},
      {{-0.000000, 0.011839, 0.164132},
       {-0.000000, 0.058930, 0.144828},
       {0.104225, -0.699383, 0.104225, -0.699383}}}},
    {0.700000,
     {1.500000, 0.200000, 0.800000},
     {0.500000, 0.066667, 0.266667},
     {{{-0.026749, -0.002076, 0.158245},
       {-0.058470, -0.039737, 0.145373},
       {0.700635, -0.378358, -0.597365, -0.095449}},
      {{0.114299, -0.106020, 0.138742},
       {0.100983, -0.090210, 0.092234},
       {0.675092, 0.595797, -0.380822, -0.210359}},
      {{-0.000000, 0.077612, 0.174890},
       {0.000000, 0.096573, 0.127659},
       {0.176355, 0.684762, 0.176355, 0.684762}}}},
    {0.000000,
     {1.000000, 1.000000, 1.000000},
     {0.600000, 0.600000, 0.600000},
     {{{-0.025000, -0.044922, 0.166901},
       {-0.025000, -0.085262, 0.135870},
       {0.707031, -0.010325, -0.707031, 0.010325}},
      {{0.025000, -0.044922, 0.166901},
       {0.025000, -0.085262, 0.135870},
       {0.707031, -0.010325, -0.707031, 0.010325}},
      {{-0.000000, 0.044922, 0.166901},
       {0.000000, 0.085262, 0.135870},
       {0.010325, -0.707031, 0.010325, -0.707031}}}},
    {1.200000,
     {0.900000, 1.100000, 0.700000},
     {0.500000, 0.450000, 0.800000},
     {{{-0.078827, -0.020927, 0.170474},
       {-0.109930, -0.033019, 0.132048},
       {0.547419, -0.348030, -0.615529, -0.447585}},
      {{0.062571, -0.014607, 0.172097},
       {0.098677, -0.028644, 0.139088},
       {0.587720, 0.405309, -0.579417, 0.393173}},
      {{-0.000000, 0.064517, 0.157652},
       {0.000000, 0.101557, 0.122749},
       {0.025025, 0.706664, 0.025025, 0.706664}}}},
    {2.500000,
     {0.100000, 2.000000, 1.000000},
     {0.300000, 0.700000, 0.400000},
     {{{-0.104951, 0.107026, 0.134210},
       {-0.096390, 0.095566, 0.085367},
       {0.184926, 0.436105, 0.556608, 0.682497}},
      {{0.008372, -0.022260, 0.115868},
       {0.035873, 0.014556, 0.137744},
       {0.170694, -0.447585, 0.547419, -0.686195}},
      {{-0.000000, 0.051891, 0.174297},
       {0.000000, 0.085262, 0.135870},
       {0.060312, 0.704530, 0.060312, 0.704530}}}},
};

int FindLink(const HandModel& hand, const std::string& name) {
  for (int i = 0; i < hand.num_links(); ++i) {
    if (hand.links()[i].name == name) return i;
  }
  return -1;
}

TEST(BarrettHand, KinematicsReproduceTheTwelvePublishedVectors) {
  const auto hand = workshop::LoadBarrettHand();
  // 40 degrees of rest bend, then to the pad point.
  const RigidTransform X_DistTip{
      Eigen::AngleAxisd(40.0 * M_PI / 180.0, Eigen::Vector3d::UnitZ())
          .toRotationMatrix(),
      Eigen::Vector3d::Zero()};
  for (const KinematicsVector& expected : kVectors) {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(hand->num_joints());
    q[workshop::FindJoint(*hand, "bh_j11_joint")] = expected.spread;
    q[workshop::FindJoint(*hand, "bh_j21_joint")] = expected.spread;
    for (int f = 0; f < 3; ++f) {
      const std::string finger = "bh_j" + std::to_string(f + 1);
      q[workshop::FindJoint(*hand, finger + "2_joint")] = expected.j2[f];
      q[workshop::FindJoint(*hand, finger + "3_joint")] = expected.j3[f];
    }
    const auto X_HL = CalcLinkPoses(*hand, q);
    for (int f = 0; f < 3; ++f) {
      const RigidTransform& X_WD = X_HL[FindLink(
          *hand, "bh_finger_" + std::to_string(f + 1) + "3_link")];
      const FingerPose& pose = expected.fingers[f];
      const Eigen::Vector3d tip =
          X_WD * X_DistTip * Eigen::Vector3d(0.050, 0.0095, 0.0);
      EXPECT_LT((tip - pose.tip).cwiseAbs().maxCoeff(), 1e-6);
      EXPECT_LT((X_WD.translation - pose.distal).cwiseAbs().maxCoeff(), 1e-6);
      const Eigen::Quaterniond R(pose.wxyz[0], pose.wxyz[1], pose.wxyz[2],
                                 pose.wxyz[3]);
      EXPECT_LT(
          CalcRotationAngle(X_WD.rotation.transpose() * R.toRotationMatrix()),
          3e-6);
    }
  }
}

TEST(BarrettHand, HasFourMotorsAndEightJoints) {
  const auto hand = workshop::LoadBarrettHand();
  EXPECT_EQ(hand->num_actuators(), 4);
  EXPECT_EQ(hand->num_joints(), 8);
  EXPECT_EQ(hand->num_links(), 9);
  EXPECT_EQ(hand->contact_points().size(), 16u);
}

TEST(BarrettHand, MotorAngleIsThreeQuartersOfBothJointsEvenAfterBreakaway) {
  const auto hand = workshop::LoadBarrettHand();
  Eigen::VectorXd motors(4);
  motors << 0.3, 0.5, 1.0, 1.5;
  Eigen::VectorXd q = hand->CalcCoupledJoints(motors);
  EXPECT_NEAR((hand->CalcActuators(q) - motors).norm(), 0.0, 1e-12);
  // F1's med link is blocked; the motor turns 0.3 rad further: J3 gains 0.4.
  const int j12 = workshop::FindJoint(*hand, "bh_j12_joint");
  const int j13 = workshop::FindJoint(*hand, "bh_j13_joint");
  EXPECT_NEAR(q[j13], q[j12] / 3.0, 1e-12);
  q[j13] += 0.4;
  EXPECT_NEAR(hand->CalcActuators(q)[1], 0.75 * (q[j12] + q[j13]), 1e-12);
  EXPECT_NEAR(hand->CalcActuators(q)[1], 0.8, 1e-12);
}

TEST(TwoJawGripper, IsReadByTheSameModel) {
  const auto gripper = workshop::MakeTwoJawGripper();
  const auto X_HL = CalcLinkPoses(*gripper, Eigen::Vector2d(0.01, 0.03));
  EXPECT_NEAR(X_HL[1].translation.x(), -0.03, 1e-15);
  EXPECT_NEAR(X_HL[2].translation.x(), 0.01, 1e-15);
}

}  // namespace
}  // namespace graspdb
