#pragma once

#include <string>

#include "engine/base/result.h"

namespace graspdb {

/** What Visit() tells of one tunable beside its name and value. */
struct ParameterInfo {
  const char* unit;    ///< SI; "1" when dimensionless.
  double minimum;      ///< Least value accepted.
  double maximum;      ///< Greatest value accepted.
  const char* source;  ///< "paper …" or "ours: …", why this value.
};

// Each struct below lists its fields once, in Visit(): names, units, ranges and
// sources for GET /v1/parameters, validation, JSON and the parameter hash all
// come from there. A visitor is called as visitor(name, field, info) for a
// double, int or bool, and visitor(name, section) for a nested struct.

/** What counts as a contact and as stable. */
struct ContactParameters {
  double friction{0.5};
  int cone_edges{8};
  double tolerance{0.0005};
  double max_normal_angle{0.7853981633974483};
  double patch_angle{0.5235987755982988};
  double min_separation{0.006};
  double stable_epsilon{1e-3};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("friction", self.friction,
      ParameterInfo{"1", 0.01, 2.0, "ours: dry plastic or metal on rubber"});
    f("cone_edges", self.cone_edges,
      ParameterInfo{"1", 8, 64, "Ferrari and Canny 1992 leave it open"});
    f("tolerance", self.tolerance,
      ParameterInfo{"m", 1e-5, 0.005,
                    "ours: hand and object this close touch"});
    f("max_normal_angle", self.max_normal_angle,
      ParameterInfo{"rad", 0.0, 1.58, "ours: opposed within 45 degrees"});
    f("patch_angle", self.patch_angle,
      ParameterInfo{"rad", 0.01, 3.15,
                    "ours: one contact patch per 30 degrees"});
    f("min_separation", self.min_separation,
      ParameterInfo{"m", 1e-4, 0.1, "ours: contacts of one patch, apart"});
    f("stable_epsilon", self.stable_epsilon,
      ParameterInfo{"1", 0.0, 1.0, "ours: least eps that counts as stable"});
  }
  bool operator==(const ContactParameters&) const = default;
};

/** Eq. (1), the hybrid grasp measure. */
struct HybridParameters {
  double distance_weight{20.0};
  double normal_weight{1.0};
  double quality_weight{20.0};
  double epsilon_floor{1e-3};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("distance_weight", self.distance_weight,
      ParameterInfo{"1/m", 0, 1e6, "paper Sec. VI-B: omega_1 = 0.02 per mm"});
    f("normal_weight", self.normal_weight,
      ParameterInfo{"1", 0, 1e6, "paper Sec. VI-B: omega_2 = 1"});
    f("quality_weight", self.quality_weight,
      ParameterInfo{"1", 0, 1e6, "paper Sec. VI-B: omega_3 = 20"});
    f("epsilon_floor", self.epsilon_floor,
      ParameterInfo{"1", 1e-9, 1, "ours: caps lg(1/eps) of unstable grasps"});
  }
  bool operator==(const HybridParameters&) const = default;
};

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
  int iterations{120};
  double acceleration{2.05};
  double max_step{0.02};
  double max_turn{0.35};
  int patience{6};
  double aimed_share{0.5};
  bool niches{true};
  bool hold_on_whole{true};
  double min_robustness{0.5};
  int robust_copies{8};
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
    f("niches", self.niches,
      ParameterInfo{"1", 0, 1, "ours: one leader per approach direction"});
    f("hold_on_whole", self.hold_on_whole,
      ParameterInfo{"1", 0, 1,
                    "ours: keep what holds on the whole example, too"});
    f("min_robustness", self.min_robustness,
      ParameterInfo{"1", 0, 1,
                    "ours: share of perturbed copies that must hold"});
    f("robust_copies", self.robust_copies,
      ParameterInfo{"1", 1, 1000,
                    "ours: copies while learning; 32 in reports"});
    f("target_grasps", self.target_grasps,
      ParameterInfo{"1", 1, 1e5, "ours: stop when so many distinct are found"});
  }
  bool operator==(const SwarmParameters&) const = default;
};

/** When two grasps count as two. */
struct DistinctParameters {
  double position{0.010};
  double angle{0.2617993877991494};
  double joint{0.2617993877991494};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("position", self.position,
      ParameterInfo{"m", 1e-4, 1, "ours: one unit of difference"});
    f("angle", self.angle,
      ParameterInfo{"rad", 1e-3, 3.2, "ours: one unit of difference"});
    f("joint", self.joint,
      ParameterInfo{"rad", 1e-3, 3.2, "ours: one unit of difference"});
  }
  bool operator==(const DistinctParameters&) const = default;
};

/** Pre-grasp: how far the fingers open and the hand retreats. */
struct PregraspParameters {
  double retreat{0.10};
  double opening{0.35};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("retreat", self.retreat,
      ParameterInfo{"m", 0, 1, "ours: free travel along the approach"});
    f("opening", self.opening,
      ParameterInfo{"1", 0.001, 10, "ours: rad or a share of a slide's range"});
  }
  bool operator==(const PregraspParameters&) const = default;
};

/** Sec. V-A, bijective contact mapping. */
struct MappingParameters {
  int samples{1500};
  double normal_weight{0.3};
  double max_normal_angle{0.5235987755982988};
  int neighbours{6};
  double consistency{0.08};
  bool affine{true};
  bool warp{true};
  bool scale{false};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("samples", self.samples,
      ParameterInfo{"1", 50, 1e5, "ours: |A| = |B|, Poisson disk"});
    f("normal_weight", self.normal_weight,
      ParameterInfo{"1", 0, 10, "ours: lambda, lengths over the rms radius"});
    f("max_normal_angle", self.max_normal_angle,
      ParameterInfo{"rad", 0, 3.15, "paper Sec. V-A: delta = pi/6"});
    f("neighbours", self.neighbours,
      ParameterInfo{"1", 1, 100, "ours: |A_x| of Eq. (4)"});
    f("consistency", self.consistency,
      ParameterInfo{"1", 1e-4, 1, "ours: gamma as a share of the diagonal"});
    f("affine", self.affine,
      ParameterInfo{"1", 0, 1,
                    "ours: contacts map under an affine refinement of T*"});
    f("warp", self.warp,
      ParameterInfo{"1", 0, 1, "ours: and bent onto the novel surface"});
    f("scale", self.scale,
      ParameterInfo{"1", 0, 1, "ours: similarity; the paper is rigid"});
  }
  bool operator==(const MappingParameters&) const = default;
};

/** Sec. V-B, local replanning by simulated annealing on Eq. (6). */
struct ReplanParameters {
  double position_weight{10.0};
  double normal_weight{5.0};
  double joint_weight{5.0};
  double quality_weight{20.0};
  double length_unit{0.01};
  double joint_range{0.35};
  int iterations{60};
  int patience{15};
  int cycles{16};
  bool aimed_starts{true};
  int extra_samples{20};
  double initial_temperature{10.0};
  double final_temperature{0.1};
  bool move_wrist{true};
  double trust_translation{0.010};
  double trust_rotation{0.17453292519943295};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("position_weight", self.position_weight,
      ParameterInfo{"1", 0, 1e6, "paper Sec. VI-B: mu_1 = 10"});
    f("normal_weight", self.normal_weight,
      ParameterInfo{"1", 0, 100, "paper Sec. VI-B: mu_2 = 5"});
    f("joint_weight", self.joint_weight,
      ParameterInfo{"1/rad", 0, 100, "paper Sec. VI-B: mu_3 = 5"});
    f("quality_weight", self.quality_weight,
      ParameterInfo{"1", 0, 1e6, "paper Sec. VI-B: mu_4 = 20"});
    f("length_unit", self.length_unit,
      ParameterInfo{"m", 1e-3, 1, "ours: Eq. (6) in centimetres"});
    f("joint_range", self.joint_range,
      ParameterInfo{"rad", 0, 3.2,
                    "ours: low and up about the example's joints"});
    f("iterations", self.iterations, ParameterInfo{"1", 0, 1e6, "ours"});
    f("patience", self.patience,
      ParameterInfo{"1", 1, 1e6, "ours: stop after so many without gain"});
    f("cycles", self.cycles,
      ParameterInfo{"1", 1, 1000, "ours: annealings at most, until one finds"});
    f("aimed_starts", self.aimed_starts,
      ParameterInfo{"1", 0, 1,
                    "ours: also from a fitted wrist, drawn back if need be"});
    f("extra_samples", self.extra_samples,
      ParameterInfo{"1", 0, 1000, "paper Sec. V-B: 20 more when in collision"});
    f("initial_temperature", self.initial_temperature,
      ParameterInfo{"1", 0, 1e6, "ours"});
    f("final_temperature", self.final_temperature,
      ParameterInfo{"1", 1e-9, 1e6, "ours"});
    f("move_wrist", self.move_wrist,
      ParameterInfo{"1", 0, 1,
                    "ours: four joints cannot meet nine conditions"});
    f("trust_translation", self.trust_translation,
      ParameterInfo{"m", 0, 0.02,
                    "ours: wrist travel; section 8 allows 20 mm"});
    f("trust_rotation", self.trust_rotation,
      ParameterInfo{"rad", 0, 0.35,
                    "ours: wrist turn; section 8 allows 20 deg"});
  }
  bool operator==(const ReplanParameters&) const = default;
};

/** When a grasp counts as transferred (and not as found from scratch). */
struct TransferLimits {
  double max_translation{0.020};
  double max_rotation{0.3490658503988659};
  double max_target_distance{0.010};
  int min_opposed_contacts{2};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("max_translation", self.max_translation,
      ParameterInfo{"m", 0, 0.02, "ours: hand from T* X_EH, at most"});
    f("max_rotation", self.max_rotation,
      ParameterInfo{"rad", 0, 0.35, "ours: hand from T* X_EH, at most"});
    f("max_target_distance", self.max_target_distance,
      ParameterInfo{"m", 0, 0.05, "ours: contact from its mapped target"});
    f("min_opposed_contacts", self.min_opposed_contacts,
      ParameterInfo{"1", 2, 10,
                    "ours: opposed contacts with a target, at least"});
  }
  bool operator==(const TransferLimits&) const = default;
};

/** Sec. IV and VI-A, parts of objects. */
struct SegmentationParameters {
  bool by_shape_diameter{false};
  int samples{1500};
  int coarse_samples{150};
  double normal_weight{0.5};
  int refined_starts{8};
  double unary_sigma{0.12};
  double unary_cap{6.0};
  double pairwise_weight{2.0};
  double min_island_share{0.02};
  double max_residual{0.12};
  double min_area_ratio{0.5};
  double max_area_ratio{2.0};
  double min_confidence{0.6};
  int shape_diameter_clusters{10};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("by_shape_diameter", self.by_shape_diameter,
      ParameterInfo{"1", 0, 1,
                    "paper Sec. VI-B; else from the labelled example"});
    f("samples", self.samples, ParameterInfo{"1", 100, 1e5, "ours"});
    f("coarse_samples", self.coarse_samples,
      ParameterInfo{"1", 50, 1e5, "ours"});
    f("normal_weight", self.normal_weight,
      ParameterInfo{"1", 0, 10,
                    "ours: 6-D distance, lengths over the rms radius"});
    f("refined_starts", self.refined_starts,
      ParameterInfo{"1", 1, 72, "ours: coarse alignments that are refined"});
    f("unary_sigma", self.unary_sigma,
      ParameterInfo{"1", 1e-3, 10, "ours: rms radii"});
    f("unary_cap", self.unary_cap, ParameterInfo{"1", 0.1, 1e3, "ours"});
    f("pairwise_weight", self.pairwise_weight,
      ParameterInfo{"1", 0, 1e3,
                    "ours: times edge length over the rms radius"});
    f("min_island_share", self.min_island_share,
      ParameterInfo{"1", 0, 0.5, "ours: smaller islands go to the neighbour"});
    f("max_residual", self.max_residual,
      ParameterInfo{"1", 0, 10,
                    "ours: mugs reach 0.11; a larger one is foreign"});
    f("min_area_ratio", self.min_area_ratio,
      ParameterInfo{"1", 0, 1, "ours: a part's area share over the example's"});
    f("max_area_ratio", self.max_area_ratio,
      ParameterInfo{"1", 1, 100,
                    "ours: a part's area share over the example's"});
    f("min_confidence", self.min_confidence,
      ParameterInfo{"1", 0, 1, "ours: below it the answer is 'unsure'"});
    f("shape_diameter_clusters", self.shape_diameter_clusters,
      ParameterInfo{"1", 1, 100, "ours: levels of thickness told apart"});
  }
  bool operator==(const SegmentationParameters&) const = default;
};

/** Every tunable of the engine. */
struct Parameters {
  SegmentationParameters segmentation;
  ContactParameters contact;
  HybridParameters hybrid;
  ActiveLearningParameters active_learning;
  SwarmParameters swarm;
  DistinctParameters distinct;
  PregraspParameters pregrasp;
  MappingParameters mapping;
  ReplanParameters replan;
  TransferLimits transfer;

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("segmentation", self.segmentation);
    f("contact", self.contact);
    f("hybrid", self.hybrid);
    f("active_learning", self.active_learning);
    f("swarm", self.swarm);
    f("distinct", self.distinct);
    f("pregrasp", self.pregrasp);
    f("mapping", self.mapping);
    f("replan", self.replan);
    f("transfer", self.transfer);
  }
  bool operator==(const Parameters&) const = default;
};

/** The best we know. */
Parameters MakeDefaultParameters();

/** The method as printed, typographical errors mended: shape-diameter
 segmentation, 40,000 labels, rigid alignment, joints only in replanning. */
Parameters MakePaperParameters();

/** Every field within its range.
 @retval kInvalidArgument naming the first field that is not. */
Result<void> ValidateParameters(const Parameters& parameters);

}  // namespace graspdb
