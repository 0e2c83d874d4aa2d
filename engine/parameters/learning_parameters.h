#pragma once

#include "engine/parameters/parameter_info.h"

namespace graspdb {

/** Sec. IV, configuration space by active learning. */
struct ActiveLearningParameters {
  int seed_samples{2000};
  int rounds{4};
  int queries_per_round{500};
  double exploration_share{0.2};
  int candidates_per_query{8};
  double penalty{10.0};
  double kernel_gamma{0.5};
  int test_samples{1000};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("seed_samples", self.seed_samples,
      ParameterInfo{"1", 10, 1e6, "ours; paper Sec. VI-B: 40,000 in all"});
    f("rounds", self.rounds, ParameterInfo{"1", 0, 1000, "ours"});
    f("queries_per_round", self.queries_per_round,
      ParameterInfo{"1", 1, 1e6, "ours"});
    f("exploration_share", self.exploration_share,
      ParameterInfo{"1", 0, 1, "ours: queries drawn at random"});
    f("candidates_per_query", self.candidates_per_query,
      ParameterInfo{"1", 1, 1000, "ours: pool from which a query is chosen"});
    f("penalty", self.penalty,
      ParameterInfo{"1", 1e-6, 1e6, "ours: C of the SVM"});
    f("kernel_gamma", self.kernel_gamma,
      ParameterInfo{"1", 1e-6, 1e6, "ours: RBF width over scaled features"});
    f("test_samples", self.test_samples,
      ParameterInfo{"1", 10, 1e6, "ours: held-out samples per report"});
  }
  bool operator==(const ActiveLearningParameters&) const = default;
};

/** Sec. IV, grasp space by particle swarm optimisation. */
struct SwarmParameters {
  int particles{200};
  int iterations{400};
  double acceleration{2.05};
  double max_step{0.02};
  double max_turn{0.35};
  int patience{3};
  double aimed_share{0.5};
  double uniform_share{0.0};
  bool niches{true};
  bool hold_on_whole{true};
  double min_grip{0.75};
  int grip_copies{8};
  double grip_weight{10.0};
  double near_share{0.5};
  double expected_yield{0.01};
  double yield_elsewhere{0.005};
  bool shun_failed{true};
  int target_grasps{300};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("particles", self.particles, ParameterInfo{"1", 1, 1e6, "ours"});
    f("iterations", self.iterations, ParameterInfo{"1", 1, 1e6, "ours"});
    f("acceleration", self.acceleration,
      ParameterInfo{"1", 2.0001, 4, "Clerc and Kennedy 2002: phi1 = phi2"});
    f("max_step", self.max_step,
      ParameterInfo{"m", 1e-4, 0.5, "ours: wrist travel per iteration"});
    f("max_turn", self.max_turn,
      ParameterInfo{"rad", 1e-3, 3.2,
                    "ours: wrist and joint turn per iteration"});
    f("patience", self.patience,
      ParameterInfo{"1", 1, 1e6,
                    "ours: iterations without gain, then restart"});
    f("aimed_share", self.aimed_share,
      ParameterInfo{"1", 0, 1,
                    "ours: restarts aimed at the surface; paper: 0"});
    f("uniform_share", self.uniform_share,
      ParameterInfo{"1", 0, 1, "ours: of the others, those from anywhere"});
    f("niches", self.niches,
      ParameterInfo{"1", 0, 1, "ours: one leader per approach direction"});
    f("hold_on_whole", self.hold_on_whole,
      ParameterInfo{"1", 0, 1,
                    "ours: keep what holds on the whole example, too"});
    f("min_grip", self.min_grip,
      ParameterInfo{
          "1", 0, 1,
          "ours: share of disturbed copies that the motors must hold"});
    f("grip_copies", self.grip_copies,
      ParameterInfo{"1", 1, 1000,
                    "ours: copies while learning; 32 in reports"});
    f("grip_weight", self.grip_weight,
      ParameterInfo{"1/N", 0, 1e6, "ours: of the residual, beside Eq. (1)"});
    f("near_share", self.near_share,
      ParameterInfo{"1", 0, 1,
                    "ours: restarts that may be near one found or nearly so"});
    f("expected_yield", self.expected_yield,
      ParameterInfo{"1", 1e-6, 1,
                    "ours: new grasps a try near one, until it is known"});
    f("yield_elsewhere", self.yield_elsewhere,
      ParameterInfo{"1", 1e-6, 1,
                    "ours: weight of starts elsewhere beside it"});
    f("shun_failed", self.shun_failed,
      ParameterInfo{"1", 0, 1,
                    "ours: no particle's best is where a grasp fell through"});
    f("target_grasps", self.target_grasps,
      ParameterInfo{"1", 1, 1e5, "ours: stop when so many distinct are found"});
  }
  bool operator==(const SwarmParameters&) const = default;
};

}  // namespace graspdb
