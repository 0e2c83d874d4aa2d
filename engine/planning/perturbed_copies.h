#pragma once

#include <cstdint>
#include <vector>

#include "engine/dynamics/closing_simulation.h"
#include "engine/parameters/parameters.h"
#include "engine/planning/grasp.h"

namespace graspdb {

/** How closely robustness is looked at: as reported, when nothing is said. */
struct RobustnessOptions {
  int copies{32};
  bool pushed{true};  ///< Whether what is gripped is pushed, too.
  /** When not 0, only grasps that are gripped so often matter: once that is out
   of reach, or not one of the first four is, the shares so far are told. */
  double least_gripped{0.0};
};

/** Copies of a grasp on one solid, each a little disturbed: the hand moved
 uniformly within a 3 mm ball and turned within 3 degrees, friction changed
 within ±20 %, fingers closed again, by estimate, from the pre-grasp. Gripped
 are those stable ones that a ClosingSimulation finds to be held, the i-th
 pushed along the i-th of ±x, ±y, ±z of O in turn. For one thread. */
class PerturbedCopies {
 public:
  /** Keeps references. The first `count` of a seed are the same for any count.
   */
  PerturbedCopies(const HandShape& hand, const Solid& solid,
                  const Parameters& parameters, uint64_t seed, int count);

  /** The shares of the copies that are stable and that are gripped.
   @param options  Its `copies` is of no account. */
  Robustness Judge(const Grasp& grasp,
                   const RobustnessOptions& options = {}) const;

  /** The share that is gripped, if it is `least` or more; else what it was when
   it became certain that it is not, or likely that it is 0. Asks first for the
   copies that tell soonest, by what became of them in earlier calls. */
  double CalcGripped(const Grasp& grasp, double least);

 private:
  struct Copy {
    Eigen::Vector3d shift;
    Eigen::Matrix3d turn;
    double friction_factor{1.0};
    Push push{Push::kNone};
    int times_lost{0};
  };
  RigidTransform Disturb(const Copy& copy, const RigidTransform& X_OH) const;
  bool IsStable(const Copy& copy, const Grasp& grasp) const;
  bool IsHeld(const Copy& copy, const Grasp& grasp, Push push) const;

  const HandShape& hand_;
  const Solid& solid_;
  const Parameters& parameters_;
  const ClosingSimulation simulation_;
  std::vector<Copy> copies_;
};

/** PerturbedCopies::Judge() of so many copies. */
Robustness CalcRobustness(const HandShape& hand, const Grasp& grasp,
                          const Solid& solid, const Parameters& parameters,
                          uint64_t seed, const RobustnessOptions& options = {});

}  // namespace graspdb
