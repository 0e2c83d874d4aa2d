#pragma once

#include "engine/parameters/parameter_info.h"

namespace graspdb {

/** Sec. IV and VI-A, parts of objects. */
struct SegmentationParameters {
  bool by_shape_diameter{false};
  int samples{1500};
  int coarse_samples{250};
  double normal_weight{0.5};
  int refined_starts{8};
  double unary_sigma{0.12};
  double unary_cap{6.0};
  double pairwise_weight{2.0};
  double min_island_share{0.02};
  double max_residual{0.12};
  double half_similarity{0.065};
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
    f("half_similarity", self.half_similarity,
      ParameterInfo{"1", 1e-3, 10,
                    "ours: dissimilarity of similarity 0.5, where auto ends"});
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

/** Sec. V-A, bijective contact mapping. */
struct MappingParameters {
  int samples{1500};
  double normal_weight{0.3};
  double max_normal_angle{0.5235987755982988};
  int neighbours{6};
  double consistency{0.08};
  bool affine{true};
  int warp_steps{12};
  double warp_first_width{0.6};
  double warp_last_width{0.2};
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
    f("warp_steps", self.warp_steps,
      ParameterInfo{"1", 0, 100, "ours: of bending onto the novel surface"});
    f("warp_first_width", self.warp_first_width,
      ParameterInfo{"1", 0.01, 10,
                    "ours: rms radii that bend as one at first"});
    f("warp_last_width", self.warp_last_width,
      ParameterInfo{"1", 0.01, 10, "ours: and in the last step"});
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
  int refits{2};
  int extra_samples{20};
  double initial_temperature{10.0};
  double final_temperature{0.1};
  bool move_wrist{true};
  double trust_translation{0.010};
  double trust_rotation{0.17453292519943295};
  double grip_weight{10.0};
  int grip_copies{16};
  double enough_grip{0.95};
  double behind_cost{0.1};
  int climb_samples{600};
  int quick_climb_samples{20};
  int searches{3};
  double likely_grip{0.75};

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
    f("refits", self.refits,
      ParameterInfo{"1", 0, 20,
                    "ours: of it, with the fingers as they closed"});
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
    f("grip_weight", self.grip_weight,
      ParameterInfo{"1/N", 0, 1e6, "ours: of the residual, beside Eq. (6)"});
    f("grip_copies", self.grip_copies,
      ParameterInfo{"1", 0, 1000,
                    "ours: perturbed copies that choose between grasps; 0: "
                    "eps chooses"});
    f("enough_grip", self.enough_grip,
      ParameterInfo{
          "1", 0, 1,
          "ours: share of them that are held; beyond it eps chooses"});
    f("behind_cost", self.behind_cost,
      ParameterInfo{"1", 0, 1,
                    "ours: share of them that it is worth to beat open-close"});
    f("climb_samples", self.climb_samples,
      ParameterInfo{"1", 0, 1e6,
                    "ours: tries around the best to get there, at most"});
    f("quick_climb_samples", self.quick_climb_samples,
      ParameterInfo{"1", 0, 1e6,
                    "ours: of them at first, when a few sure grasps do"});
    f("searches", self.searches,
      ParameterInfo{"1", 1, 100,
                    "ours: with their climbs, at most, until one is likely"});
    f("likely_grip", self.likely_grip,
      ParameterInfo{"1", 0, 1,
                    "ours: share of copies held; below it search again"});
  }
  bool operator==(const ReplanParameters&) const = default;
};

/** When a grasp counts as transferred (and not as found from scratch). */
struct TransferLimits {
  double max_translation{0.020};
  double max_rotation{0.3490658503988659};
  double max_target_distance{0.010};
  int min_opposed_contacts{2};
  double min_clearance{0.010};
  double sure_grip{0.9};

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
    f("min_clearance", self.min_clearance,
      ParameterInfo{"m", 0, 0.2,
                    "ours: hand from a part that the task keeps free"});
    f("sure_grip", self.sure_grip,
      ParameterInfo{"1", 0, 1,
                    "ours: share of copies held; enough to stop looking"});
  }
  bool operator==(const TransferLimits&) const = default;
};

}  // namespace graspdb
