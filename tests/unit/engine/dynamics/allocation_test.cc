#include <vector>

#include <gtest/gtest.h>

#include "engine/dynamics/closing_simulation.h"
#include "tests/support/allocation_count.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

TEST(Allocations, AreCounted) {
  const int before = CountAllocations();
  const Eigen::VectorXd vector = Eigen::VectorXd::Ones(100);
  const std::vector<double> other(100, vector.sum());
  EXPECT_EQ(other[0], 100.0);
  EXPECT_EQ(CountAllocations() - before, 2);
}

TEST(Allocations, AreNotMadeByAStepOfAClosing) {
  const HandShape gripper(workshop::MakeTwoJawGripper());
  const Solid box(workshop::MakeBox({0.04, 0.03, 0.05}, 2));
  const auto count = [&](double time_step) {
    HoldParameters parameters;
    parameters.time_step = time_step;
    const ClosingSimulation simulation(gripper, box, parameters,
                                       MotorParameters());
    const int before = CountAllocations();
    const ClosingOutcome outcome = simulation.Run(
        {Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.004, 0, -0.07)},
        Eigen::Vector2d::Zero(), 0.5);
    EXPECT_TRUE(outcome.held);
    return CountAllocations() - before;
  };
  // Ten times as many steps, of which there are hundreds.
  const double time_step = HoldParameters().time_step;
  EXPECT_LT(count(0.1 * time_step), count(time_step) + 50);
}

}  // namespace
}  // namespace graspdb
