#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "engine/planning/grasp_evaluator.h"
#include "engine/quality/epsilon_quality.h"
#include "tests/support/allocation_count.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

/** What a call asks memory for once it has been made before: a thread keeps
 what it works with. */
template <class F>
int CountAllocationsOf(const F& call) {
  call();
  const int before = CountAllocations();
  call();
  return CountAllocations() - before;
}

// The gripper looks down on a box of some width.
class Allocations : public ::testing::Test {
 protected:
  static Solid MakeBox(double width) {
    return Solid(workshop::MakeBox({width, 0.04, 0.04}, 4));
  }

  const HandShape hand_{workshop::MakeTwoJawGripper()};
  const RigidTransform X_OH_{
      Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix(),
      {0, 0, 0.07}};
  const Eigen::VectorXd open_{Eigen::Vector2d::Zero()};
  const Parameters parameters_;
};

TEST_F(Allocations, AreNotMadeByACollisionTest) {
  const Solid box = MakeBox(0.04);
  const auto X_HL = CalcLinkPoses(hand_.model(), open_);
  for (const double z : {0.03, 0.07}) {
    RigidTransform X_OH = X_OH_;
    X_OH.translation.z() = z;
    EXPECT_EQ(CountAllocationsOf(
                  [&] { return FindCollidingLink(hand_, X_OH, X_HL, box); }),
              0);
    EXPECT_EQ(CountAllocationsOf([&] {
                return EstimateCollidingLink(hand_, X_OH, X_HL, box);
              }),
              0);
  }
  EXPECT_EQ(CountAllocationsOf([&] { return FindSelfCollision(hand_, X_HL); }),
            0);
}

TEST_F(Allocations, AreNotMadeByAStepOfAClosing) {
  const auto count = [&](double width, Precision precision) {
    const Solid box = MakeBox(width);
    return CountAllocationsOf(
        [&] { return CloseFingers(hand_, X_OH_, open_, box, precision); });
  };
  for (const Precision precision : {Precision::kExact, Precision::kEstimated}) {
    // Twice the way and more, of which each half degree is a step.
    EXPECT_LE(count(0.02, precision), count(0.06, precision) + 4);
  }
}

TEST_F(Allocations, AreNotMadeByAStepOfThePolytope) {
  const Solid box = MakeBox(0.04);
  const EvaluatedGrasp closed =
      CloseAndJudge(hand_, X_OH_, open_, box, parameters_);
  ASSERT_TRUE(closed.ok());
  const Wrenches wrenches = CalcContactWrenches(
      closed.grasp.contacts, box.mass(), parameters_.contact);
  EXPECT_EQ(CountAllocationsOf([&] { return CalcEpsilonQuality(wrenches); }),
            0);
}

TEST_F(Allocations, AreFewWhenAGraspIsJudged) {
  const Solid box = MakeBox(0.04);
  EXPECT_LT(CountAllocationsOf([&] {
              return CloseAndJudge(hand_, X_OH_, open_, box, parameters_);
            }),
            120);
}

}  // namespace
}  // namespace graspdb
