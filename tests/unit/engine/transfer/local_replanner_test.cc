#include "engine/transfer/local_replanner.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/planning/grasp_evaluator.h"
#include "engine/planning/perturbed_copies.h"
#include "engine/transfer/open_close.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// The gripper on a 40 mm box, as a source grasp for other boxes.
class GripperTask : public ::testing::Test {
 protected:
  GripperTask() {
    task_.X_NH = {
        Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix(),
        {0, 0, 0.07}};
    task_.q_pregrasp = Eigen::Vector2d::Zero();
    task_.q = Eigen::Vector2d(0.02, 0.02);
    // Jaw 1 is on the left in H and, H being turned about x, in O.
    task_.targets = {{1, {0, 0, 0.05}, {1, 0, 0}, {-0.02, 0, 0}, {-1, 0, 0}},
                     {2, {0, 0, 0.05}, {-1, 0, 0}, {0.02, 0, 0}, {1, 0, 0}}};
  }

  const HandShape hand_{workshop::MakeTwoJawGripper()};
  const Parameters parameters_;
  TransferTask task_;
};

TEST_F(GripperTask, ReplansOntoABoxThatIsNotQuiteThere) {
  const Solid moved(CalcTransformed(
      workshop::MakeBox({0.044, 0.04, 0.04}, 4),
      {Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.004, 0.002, 0)}));
  // Contacts may lie a centimetre from their targets: jaws meet low down.
  const ReplanResult result = Replan(hand_, task_, moved, parameters_, 3);
  ASSERT_EQ(result.outcome, TransferOutcome::kSucceeded);
  EXPECT_TRUE(IsTransferOf(task_, *result.grasp, parameters_.transfer));
  EXPECT_GE(result.grasp->quality.epsilon, parameters_.contact.stable_epsilon);
}

TEST_F(GripperTask, AStartThatHoldsIsAnAnswerWithoutAnySearch) {
  const Solid box(workshop::MakeBox({0.04, 0.04, 0.04}, 4));
  const EvaluatedGrasp closed =
      CloseAndJudge(hand_, task_.X_NH, task_.q_pregrasp, box, parameters_);
  ASSERT_TRUE(closed.ok());
  for (const Contact& contact : closed.grasp.contacts) {
    task_.targets[static_cast<size_t>(contact.link - 1)].p_N = contact.p_O;
  }
  Parameters unsearched = parameters_;
  unsearched.replan.iterations = 0;
  for (const int searches : {1, 3}) {
    const ReplanResult result =
        Replan(hand_, task_, box, unsearched, 3, {.searches = searches});
    EXPECT_EQ(result.outcome, TransferOutcome::kSucceeded);
  }
}

TEST_F(GripperTask, MoreSearchesFindNoWorseAGraspAndOneThatIsLikelyEndsThem) {
  const Solid box(workshop::MakeBox({0.04, 0.04, 0.04}, 4));
  const auto share_of = [&](const ReplanResult& result) {
    return CalcRobustness(hand_, *result.grasp, box, parameters_, 3,
                          {.copies = parameters_.replan.grip_copies})
        .gripped;
  };
  const auto one = Replan(hand_, task_, box, parameters_, 3, {.searches = 1});
  const auto more = Replan(hand_, task_, box, parameters_, 3, {.searches = 3});
  ASSERT_TRUE(one.grasp && more.grasp);
  EXPECT_GE(share_of(more), share_of(one));
  Parameters content = parameters_;
  content.replan.likely_grip = 0.0;
  const auto ended = Replan(hand_, task_, box, content, 3, {.searches = 3});
  EXPECT_EQ(*ended.grasp, *one.grasp);
}

TEST_F(GripperTask, UntilSureTheFirstSureGraspEndsTheSearch) {
  const Solid box(workshop::MakeBox({0.04, 0.04, 0.04}, 4));
  const auto count_samples = [&](bool until_sure) {
    int asked = 0;
    const ReplanResult result = Replan(
        hand_, task_, box, parameters_, 3,
        {.climb_samples = 30, .until_sure = until_sure, .wanted = [&asked] {
           ++asked;
           return true;
         }});
    EXPECT_EQ(result.outcome, TransferOutcome::kSucceeded);
    EXPECT_GE(CalcRobustness(hand_, *result.grasp, box, parameters_, 3,
                             {.copies = parameters_.replan.grip_copies})
                  .gripped,
              parameters_.replan.enough_grip);
    return asked;
  };
  EXPECT_LT(count_samples(true), count_samples(false));
}

TEST_F(GripperTask, TheFittedWristBringsContactsNearerToTheirTargets) {
  const auto find_misfit = [this](const RigidTransform& X_NH) {
    double sum = 0.0;
    for (const ContactTarget& target : task_.targets) {
      const RigidTransform X_HL =
          CalcLinkPose(hand_.model(), task_.q, target.link);
      sum += (X_NH * (X_HL * target.p_L) - target.p_N).squaredNorm();
    }
    return sum;
  };
  // Targets where the contacts are: nothing moves.
  for (ContactTarget& target : task_.targets) {
    target.p_N =
        task_.X_NH *
        (CalcLinkPose(hand_.model(), task_.q, target.link) * target.p_L);
  }
  EXPECT_LT(
      (FitWrist(hand_.model(), task_).translation - task_.X_NH.translation)
          .norm(),
      1e-9);
  // 10 mm aside: the hand follows, its frame holds it back a little.
  for (ContactTarget& target : task_.targets) target.p_N.y() += 0.010;
  const double before = find_misfit(task_.X_NH);
  const double after = find_misfit(FitWrist(hand_.model(), task_));
  EXPECT_LT(after, 0.5 * before);
  EXPECT_GT(after, 0.0);
}

TEST_F(GripperTask, TheSameSeedGivesTheSameGrasp) {
  const Solid box(workshop::MakeBox({0.04, 0.04, 0.04}, 4));
  const auto a = Replan(hand_, task_, box, parameters_, 3);
  const auto b = Replan(hand_, task_, box, parameters_, 3);
  ASSERT_TRUE(a.grasp && b.grasp);
  EXPECT_EQ(*a.grasp, *b.grasp);
}

TEST_F(GripperTask, ABoxOutOfReachIsNoContact) {
  const Solid far(CalcTransformed(
      workshop::MakeBox({0.04, 0.04, 0.04}, 4),
      {Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, -0.1)}));
  const ReplanResult result = Replan(hand_, task_, far, parameters_, 3);
  EXPECT_EQ(result.outcome, TransferOutcome::kNoContact);
  EXPECT_FALSE(result.grasp.has_value());
}

TEST_F(GripperTask, ABoxTooWideIsAFingerCollision) {
  const Solid wide(workshop::MakeBox({0.12, 0.04, 0.04}, 4));
  EXPECT_EQ(Replan(hand_, task_, wide, parameters_, 3).outcome,
            TransferOutcome::kFingerCollision);
}

TEST_F(GripperTask, AHandThatHasGoneAstrayIsNoTransfer) {
  const Solid box(workshop::MakeBox({0.04, 0.04, 0.04}, 4));
  Grasp grasp = *Replan(hand_, task_, box, parameters_, 3).grasp;
  grasp.configuration.X_OH.translation.y() += 0.03;
  EXPECT_FALSE(IsTransferOf(task_, grasp, parameters_.transfer));
}

TEST_F(GripperTask, AssemblyDrawsThePalmBackFromTheRestOfTheObject) {
  const Solid box(workshop::MakeBox({0.04, 0.04, 0.04}, 4));
  const Grasp grasp = *Replan(hand_, task_, box, parameters_, 3).grasp;
  // The whole object rises 3 mm into the gripper's base.
  const double top = grasp.configuration.X_OH.translation.z() - 0.02 + 0.003;
  const Solid taller(CalcTransformed(
      workshop::MakeBox({0.04, 0.04, top + 0.02}, 4),
      {Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, 0.5 * top - 0.01)}));
  const ReplanResult result =
      Assemble(hand_, task_, grasp, taller, parameters_, 3);
  ASSERT_EQ(result.outcome, TransferOutcome::kSucceeded);
  EXPECT_GT(result.grasp->configuration.X_OH.translation.z(), top + 0.02);
}

TEST_F(GripperTask, AssemblyOnAnObjectThatFillsThePalmIsAPalmCollision) {
  const Solid box(workshop::MakeBox({0.04, 0.04, 0.04}, 4));
  const Grasp grasp = *Replan(hand_, task_, box, parameters_, 3).grasp;
  const Solid tower(workshop::MakeBox({0.04, 0.04, 0.2}, 4));
  EXPECT_EQ(Assemble(hand_, task_, grasp, tower, parameters_, 3).outcome,
            TransferOutcome::kPalmCollision);
}

TEST_F(GripperTask, TheBaselineClosesWhereItStands) {
  const Solid box(workshop::MakeBox({0.04, 0.04, 0.04}, 4));
  EXPECT_GT(CalcOpenCloseEpsilon(hand_, task_, box, parameters_), 0.0);
  const Solid wide(workshop::MakeBox({0.12, 0.04, 0.04}, 4));
  EXPECT_EQ(CalcOpenCloseEpsilon(hand_, task_, wide, parameters_), 0.0);
}

}  // namespace
}  // namespace graspdb
