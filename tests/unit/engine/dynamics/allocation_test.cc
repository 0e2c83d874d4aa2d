#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "engine/dynamics/closing_simulation.h"
#include "tests/support/workshop.h"

// The linker sends here what this program's own objects ask for memory, Eigen's
// vectors included (--wrap in CMakeLists.txt).
namespace {
int num_allocations = 0;
}  // namespace

extern "C" {
void* __real_malloc(std::size_t size);
void* __wrap_malloc(std::size_t size) {
  ++num_allocations;
  return __real_malloc(size);
}
void* __real__Znwm(std::size_t size);
void* __wrap__Znwm(std::size_t size) {
  ++num_allocations;
  return __real__Znwm(size);
}
}

namespace graspdb {
namespace {

TEST(Allocations, AreCounted) {
  num_allocations = 0;
  const Eigen::VectorXd vector = Eigen::VectorXd::Ones(100);
  const std::vector<double> other(100, vector.sum());
  EXPECT_EQ(other[0], 100.0);
  EXPECT_EQ(num_allocations, 2);
}

TEST(Allocations, AreNotMadeByAStepOfAClosing) {
  const HandShape gripper(workshop::MakeTwoJawGripper());
  const Solid box(workshop::MakeBox({0.04, 0.03, 0.05}, 2));
  const auto count = [&](double time_step) {
    HoldParameters parameters;
    parameters.time_step = time_step;
    const ClosingSimulation simulation(gripper, box, parameters,
                                       MotorParameters());
    num_allocations = 0;
    const ClosingOutcome outcome = simulation.Run(
        {Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.004, 0, -0.07)},
        Eigen::Vector2d::Zero(), 0.5);
    EXPECT_TRUE(outcome.held);
    return num_allocations;
  };
  // Ten times as many steps, of which there are hundreds.
  const double time_step = HoldParameters().time_step;
  EXPECT_LT(count(0.1 * time_step), count(time_step) + 50);
}

}  // namespace
}  // namespace graspdb
