#include "engine/cspace/active_learner.h"

#include <gtest/gtest.h>

#include "tests/support/workshop.h"

namespace graspdb {
namespace {

class LearnTheGripper : public ::testing::Test {
 protected:
  LearnTheGripper() {
    parameters_.seed_samples = 400;
    parameters_.rounds = 3;
    parameters_.queries_per_round = 200;
    parameters_.test_samples = 500;
  }

  const HandShape hand_{workshop::MakeTwoJawGripper()};
  const Solid box_{workshop::MakeBox({0.05, 0.05, 0.1}, 4)};
  const ConfigurationSpace space_{hand_, box_};
  ActiveLearningParameters parameters_;
  ExecutionContext context_;
};

TEST_F(LearnTheGripper, AccuracyBeatsChanceAndRoundsAddSamples) {
  const auto learned =
      LearnConfigurationSpace(space_, parameters_, 1, context_).value();
  ASSERT_EQ(learned.rounds.size(), 4u);
  EXPECT_EQ(learned.rounds.front().samples, 400);
  EXPECT_EQ(learned.rounds.back().samples, 1000);
  EXPECT_GT(learned.rounds.back().balanced_accuracy, 0.65);
}

TEST_F(LearnTheGripper, ParticlesAreCollisionFree) {
  const auto learned =
      LearnConfigurationSpace(space_, parameters_, 1, context_).value();
  ASSERT_GT(learned.free_support_vectors.size(), 20u);
  for (const HandPosture& posture : learned.free_support_vectors) {
    EXPECT_FALSE(space_.Collides(posture));
  }
}

TEST_F(LearnTheGripper, TheSameSeedGivesTheSameParticles) {
  const auto a =
      LearnConfigurationSpace(space_, parameters_, 7, context_).value();
  const auto b =
      LearnConfigurationSpace(space_, parameters_, 7, context_).value();
  ASSERT_EQ(a.free_support_vectors.size(), b.free_support_vectors.size());
  for (size_t i = 0; i < a.free_support_vectors.size(); ++i) {
    EXPECT_EQ(a.free_support_vectors[i].X_OH, b.free_support_vectors[i].X_OH);
  }
  EXPECT_EQ(a.rounds, b.rounds);
}

TEST_F(LearnTheGripper, CancellingEndsIt) {
  context_.Cancel();
  const auto learned =
      LearnConfigurationSpace(space_, parameters_, 1, context_);
  ASSERT_FALSE(learned);
  EXPECT_EQ(learned.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace graspdb
