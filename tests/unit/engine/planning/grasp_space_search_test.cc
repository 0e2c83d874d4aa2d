#include "engine/planning/grasp_space_search.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/parallel.h"
#include "engine/cspace/active_learner.h"
#include "engine/planning/grasp_archive.h"
#include "engine/planning/grasp_evaluator.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

TEST(Constriction, IsClercAndKennedysValue) {
  // φ = 4.1: 2 / |2 - 4.1 - √(0.41)| = 2 / 2.740312… = 0.729843…
  EXPECT_NEAR(CalcConstriction(4.1), 0.7298437881, 1e-9);
}

class GripperSwarm : public ::testing::Test {
 protected:
  GripperSwarm() {
    parameters_.swarm.particles = 30;
    parameters_.swarm.iterations = 40;
    parameters_.active_learning.seed_samples = 300;
    parameters_.active_learning.rounds = 1;
    parameters_.active_learning.queries_per_round = 100;
    parameters_.active_learning.test_samples = 50;
    seeds_ = LearnConfigurationSpace(space_, parameters_.active_learning, 1,
                                     context_)
                 .value()
                 .free_support_vectors;
  }

  GraspSearchResult Run(int threads) {
    return RunWithThreads(threads, [&] {
      return SearchGraspSpace(hand_, box_, nullptr, space_, seeds_, parameters_,
                              5, context_);
    });
  }

  const HandShape hand_{workshop::MakeTwoJawGripper()};
  const Solid box_{workshop::MakeBox({0.04, 0.04, 0.08}, 4)};
  const ConfigurationSpace space_{hand_, box_};
  Parameters parameters_;
  ExecutionContext context_;
  std::vector<HandPosture> seeds_;
};

TEST_F(GripperSwarm, FindsDistinctStableReachableGrasps) {
  const GraspSearchResult found = Run(2);
  ASSERT_GT(found.grasps.size(), 5u);
  EXPECT_GT(found.coverage, 0.0);
  for (size_t i = 0; i < found.grasps.size(); ++i) {
    const Grasp& grasp = found.grasps[i];
    EXPECT_GE(grasp.quality.epsilon, parameters_.contact.stable_epsilon);
    EXPECT_TRUE(IsReachable(hand_, grasp, box_));
    for (size_t j = 0; j < i; ++j) {
      EXPECT_GE(
          CalcGraspDifference(grasp, found.grasps[j], parameters_.distinct),
          1.0);
    }
    // Closing again gives the same joints.
    const EvaluatedGrasp again = CloseAndJudge(
        hand_, grasp.configuration.X_OH, grasp.q_pregrasp, box_, parameters_);
    EXPECT_EQ(again.grasp.configuration.q, grasp.configuration.q);
  }
}

TEST_F(GripperSwarm, OneAndTwoThreadsFindTheSameBytes) {
  const GraspSearchResult one = Run(1);
  const GraspSearchResult two = Run(2);
  EXPECT_EQ(one.grasps, two.grasps);
}

}  // namespace
}  // namespace graspdb
