#include "engine/transfer/transfer_task.h"

#include <gtest/gtest.h>

#include "engine/base/random.h"

namespace graspdb {
namespace {

TEST(Confine, BringsAnyPoseWithinTheLimitsAndLeavesThoseThatAre) {
  const TransferLimits limits;
  Random random(1);
  int confined = 0;
  for (int i = 0; i < 1000; ++i) {
    TransferTask task;
    task.X_NH = {random.NextRotation(), random.NextInUnitBall()};
    const double scale = random.NextUniform(0.0, 3.0);
    const RigidTransform X_NH{
        task.X_NH.rotation *
            random.NextRotationWithin(scale * limits.max_rotation),
        task.X_NH.translation +
            scale * limits.max_translation * random.NextInUnitBall()};
    const RigidTransform near = Confine(X_NH, task, limits);
    const double shift = (near.translation - task.X_NH.translation).norm();
    const double turn =
        CalcRotationAngle(task.X_NH.rotation.transpose() * near.rotation);
    EXPECT_LT(shift, limits.max_translation);
    EXPECT_LT(turn, limits.max_rotation);
    EXPECT_TRUE(near.rotation.isUnitary(1e-9));
    const RigidTransform again = Confine(near, task, limits);
    EXPECT_TRUE(again.translation.isApprox(near.translation, 1e-12));
    EXPECT_TRUE(again.rotation.isApprox(near.rotation, 1e-9));
    if (scale < 0.9) {
      EXPECT_EQ(near.translation, X_NH.translation);
      EXPECT_EQ(near.rotation, X_NH.rotation);
    } else {
      confined += near.translation != X_NH.translation;
    }
  }
  EXPECT_GT(confined, 100);
}

}  // namespace
}  // namespace graspdb
