#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/dynamics/arrow_system.h"
#include "engine/geometry/solid.h"
#include "engine/hand/hand_shape.h"
#include "engine/parameters/grasp_parameters.h"

namespace graspdb {

/** Which pushes an object is to withstand, once it is at rest between the
 fingers, each of hold.push from where it settled. */
enum class Push {
  kPlusX,
  kMinusX,
  kPlusY,
  kMinusY,
  kPlusZ,
  kMinusZ,
  kAll,
  kNone
};

/** Those along one axis are numbered from 0. */
inline constexpr int kNumPushes = 6;

/** What became of an object that a hand closed on. */
struct ClosingOutcome {
  bool settled{false};  ///< At rest between the fingers, not far from where …
  double shift{0.0};    ///< … it was: how far its mass centre went, m, …
  double turn{0.0};     ///< … and how far it turned, rad.
  bool held{false};     ///< Settled, and withstood the pushes.
};

/** Whether a hand holds what it closes on: the object floats, the hand's base
 stands still, and the fingers close as their motors drive them, each joint
 until it has met its torque and then as its worm gear stands. What touches the
 object first pushes it; what presses it out between two fingers loses it. Rigid
 bodies with springy contacts and Coulomb friction, in implicit steps of some
 milliseconds: rough, and fast enough to choose between grasps by it. Shares no
 code with the GraspSimulator that verifies them. Immutable; shared by threads.
 [Anitescu and Potra 2002 for the implicit, linearised steps] */
class ClosingSimulation {
 public:
  /** Keeps references to hand and solid. */
  ClosingSimulation(const HandShape& hand, const Solid& solid,
                    const HoldParameters& parameters,
                    const MotorParameters& motors);

  /** @param X_OH  Where the hand stands. @param q_open  All joints before
   closing, free of collision. @param friction  Coulomb's. @param push  Along
   the axes of O. */
  ClosingOutcome Run(const RigidTransform& X_OH, const Eigen::VectorXd& q_open,
                     double friction, Push push = Push::kAll) const;

 private:
  friend class ClosingRun;

  // A joint that closes.
  struct ClosingJoint {
    int joint{0};
    double sign{1.0};   // Of its closing: 1, or -1 if it mimics backwards.
    double limit{0.0};  // Where it ends then, rad or m.
    double speed{0.0};  // While the joint before it turns, rad/s or m/s …
    double released_speed{0.0};  // … and once that is blocked.
    double stiffness{0.0};       // N m/rad or N/m.
    double damping{0.0};
    double armature{0.0};        // kg m² or kg.
    double closing_torque{0.0};  // N m or N.
    double holding_torque{0.0};
    bool is_first{false};  // Of its motor's chain.
  };

  const HandShape& hand_;
  const Solid& solid_;
  const HoldParameters parameters_;
  std::vector<ClosingJoint> joints_;
  std::vector<std::vector<int>> movers_;  // Per link: indices into joints_.
  ArrowSystem system_{0, {}};             // All zero.
  double near_{0.0};  // What is as near as that may touch within a step, m.
};

}  // namespace graspdb
