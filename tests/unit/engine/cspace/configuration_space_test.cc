#include "engine/cspace/configuration_space.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/workshop.h"

namespace graspdb {
namespace {

class BarrettAroundABox : public ::testing::Test {
 protected:
  const HandShape hand_{workshop::LoadBarrettHand()};
  const Solid box_{workshop::MakeBox({0.05, 0.05, 0.1}, 4)};
  const ConfigurationSpace space_{hand_, box_};
};

TEST_F(BarrettAroundABox, SamplesStayInTheRegionAndTheMotorsInTheirRange) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const HandPosture posture =
        i % 2 == 0 ? space_.Sample(random) : space_.SampleAimed(random);
    for (int a = 0; a < hand_.model().num_actuators(); ++a) {
      EXPECT_GE(posture.actuators[a], hand_.model().actuators()[a].lower);
      EXPECT_LE(posture.actuators[a], hand_.model().actuators()[a].upper);
    }
    if (i % 2 == 0) {
      const Eigen::Vector3d p_OG = posture.X_OH * space_.p_HG();
      EXPECT_LE(p_OG.cwiseAbs().x(), 0.025 + 0.03 + 1e-9);
      EXPECT_LE(p_OG.cwiseAbs().z(), 0.05 + 0.03 + 1e-9);
    }
  }
}

TEST_F(BarrettAroundABox, FeaturesHaveNoSeamAtAHalfTurn) {
  HandPosture a, b;
  a.actuators = b.actuators = Eigen::VectorXd::Zero(4);
  a.X_OH.rotation = Eigen::AngleAxisd(M_PI - 1e-4, Eigen::Vector3d::UnitZ())
                        .toRotationMatrix();
  b.X_OH.rotation = Eigen::AngleAxisd(-M_PI + 1e-4, Eigen::Vector3d::UnitZ())
                        .toRotationMatrix();
  EXPECT_LT((space_.CalcFeatures(a) - space_.CalcFeatures(b)).norm(), 1e-3);
}

TEST_F(BarrettAroundABox, PerturbedPosturesStayWithinTheStep) {
  Random random(2);
  const HandPosture start = space_.Sample(random);
  for (int i = 0; i < 200; ++i) {
    const HandPosture moved = space_.Perturb(start, 0.005, 0.1, random);
    EXPECT_LE((moved.X_OH * space_.p_HG() - start.X_OH * space_.p_HG()).norm(),
              0.005 + 1e-12);
    EXPECT_LE(CalcRotationAngle(start.X_OH.rotation.transpose() *
                                moved.X_OH.rotation),
              0.1 + 1e-9);
  }
}

TEST_F(BarrettAroundABox, AHandFarAwayIsFreeAndOneInsideCollides) {
  HandPosture posture;
  posture.actuators = Eigen::VectorXd::Zero(4);
  posture.X_OH.translation.z() = -0.5;
  EXPECT_FALSE(space_.Collides(posture));
  posture.X_OH.translation.z() = -0.06;
  EXPECT_TRUE(space_.Collides(posture));
}

}  // namespace
}  // namespace graspdb
