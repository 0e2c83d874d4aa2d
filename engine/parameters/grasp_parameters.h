#pragma once

#include "engine/parameters/parameter_info.h"

namespace graspdb {

/** What counts as a contact and as stable. */
struct ContactParameters {
  double friction{0.5};
  int cone_edges{8};
  double tolerance{0.0005};
  double max_normal_angle{0.7853981633974483};
  double patch_angle{0.5235987755982988};
  double min_separation{0.006};
  double stable_epsilon{1e-3};
  double unseen_force{0.5};

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
    f("unseen_force", self.unseen_force,
      ParameterInfo{"1", 0.0, 1.0,
                    "ours: of a contact where a cloud shows no surface"});
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

/** What a finger exerts and bears, as a force at its farthest point. */
struct MotorParameters {
  double closing_force{5.0};
  double holding_force{15.0};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("closing_force", self.closing_force,
      ParameterInfo{"N", 0, 1e3, "ours: as hard as fingers close"});
    f("holding_force", self.holding_force,
      ParameterInfo{"N", 0, 1e3, "BH8-280: 15 N at the fingertip"});
  }
  bool operator==(const MotorParameters&) const = default;
};

/** What a grip is, see CalcGripResidual(). */
struct GripParameters {
  double push{1.0};
  double least_force{2.0};
  double friction_share{0.8};
  double max_residual{0.1};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("push", self.push,
      ParameterInfo{"N", 0, 1e3, "ours: what a grip is to withstand"});
    f("least_force", self.least_force,
      ParameterInfo{"N", 0, 1e3, "ours: what is left of it at the least"});
    f("friction_share", self.friction_share,
      ParameterInfo{"1", 0.01, 1, "ours: of the friction that is counted on"});
    f("max_residual", self.max_residual,
      ParameterInfo{"N", 1e-3, 1e3, "ours: unbalanced, and still a grip"});
  }
  bool operator==(const GripParameters&) const = default;
};

/** What a ClosingSimulation simulates, and what counts as held. */
struct HoldParameters {
  double mass{0.1};
  double closing_speed{1.0};
  double stiffness{100.0};
  double contact_stiffness{5e4};
  double push{1.0};
  double push_seconds{0.3};
  double settle_seconds{0.06};
  double max_shift{0.02};
  double max_turn{0.2617993877991494};
  double time_step{0.002};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("mass", self.mass, ParameterInfo{"kg", 1e-3, 100, "ours: of the object"});
    f("closing_speed", self.closing_speed,
      ParameterInfo{"rad/s", 1e-3, 10, "ours: of a motor"});
    f("stiffness", self.stiffness,
      ParameterInfo{"N m/rad", 1, 1e6, "ours: of a joint until it yields"});
    f("contact_stiffness", self.contact_stiffness,
      ParameterInfo{"N/m", 1, 1e9, "ours: of a point of the skin"});
    f("push", self.push,
      ParameterInfo{"N", 0, 1e3, "ours: once at rest, along an axis"});
    f("push_seconds", self.push_seconds,
      ParameterInfo{"s", 1e-3, 100, "ours: long enough to get going"});
    f("settle_seconds", self.settle_seconds,
      ParameterInfo{"s", 1e-3, 100, "ours: at rest for so long"});
    f("max_shift", self.max_shift,
      ParameterInfo{"m", 1e-4, 1, "ours: beyond it the object is lost"});
    f("max_turn", self.max_turn,
      ParameterInfo{"rad", 1e-3, 3.2, "ours: beyond it the object is lost"});
    f("time_step", self.time_step,
      ParameterInfo{"s", 1e-4, 0.01, "ours: as long as it stays true"});
  }
  bool operator==(const HoldParameters&) const = default;
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

/** Pre-grasp: how far the fingers open and the hand retreats, and whether all
 fingers meet the object together, see TimeFingers(). */
struct PregraspParameters {
  double retreat{0.10};
  double opening{0.35};
  bool timed{true};

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("retreat", self.retreat,
      ParameterInfo{"m", 0, 1, "ours: free travel along the approach"});
    f("opening", self.opening,
      ParameterInfo{"1", 0.001, 10, "ours: rad or a share of a slide's range"});
    f("timed", self.timed,
      ParameterInfo{"1", 0, 1, "ours: fingers that meet the object together"});
  }
  bool operator==(const PregraspParameters&) const = default;
};

}  // namespace graspdb
