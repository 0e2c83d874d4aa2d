#include "engine/planning/perturbed_copies.h"

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/planning/grasp_evaluator.h"

namespace graspdb {
namespace {

constexpr double kShift = 0.003;              // m
constexpr double kTurn = 3.0 * M_PI / 180.0;  // rad
constexpr double kFriction = 0.2;
// When grasps are compared, one is given up after so many lost copies.
constexpr int kHopeless = 4;
// To tell whether a larger share is reached takes the copies that are hard, a
// smaller one those that are easy.
constexpr double kLargeShare = 0.5;

}  // namespace

PerturbedCopies::PerturbedCopies(const HandShape& hand, const Solid& solid,
                                 const Parameters& parameters, uint64_t seed,
                                 int count)
    : hand_(hand),
      solid_(solid),
      parameters_(parameters),
      simulation_(hand, solid, parameters.hold, parameters.motors) {
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    Copy copy;
    copy.shift = kShift * random.NextInUnitBall();
    copy.turn = random.NextRotationWithin(kTurn);
    copy.friction_factor = 1.0 + random.NextUniform(-kFriction, kFriction);
    copy.push = static_cast<Push>(i % kNumPushes);
    copies_.push_back(copy);
  }
}

RigidTransform PerturbedCopies::Disturb(const Copy& copy,
                                        const RigidTransform& X_OH) const {
  return {X_OH.rotation * copy.turn, X_OH.translation + copy.shift};
}

bool PerturbedCopies::IsStable(const Copy& copy, const Grasp& grasp) const {
  Parameters perturbed = parameters_;
  perturbed.contact.friction *= copy.friction_factor;
  return CloseAndJudge(hand_, Disturb(copy, grasp.configuration.X_OH),
                       grasp.q_pregrasp, solid_, perturbed,
                       Precision::kEstimated)
      .ok();
}

bool PerturbedCopies::IsHeld(const Copy& copy, const Grasp& grasp,
                             Push push) const {
  return simulation_
      .Run(Disturb(copy, grasp.configuration.X_OH), grasp.q_pregrasp,
           parameters_.contact.friction * copy.friction_factor, push)
      .held;
}

Robustness PerturbedCopies::Judge(const Grasp& grasp,
                                  const RobustnessOptions& options) const {
  const int count = static_cast<int>(copies_.size());
  const double least = options.least_gripped;
  int stable = 0;
  int gripped = 0;
  for (int i = 0; i < count; ++i) {
    if (gripped + count - i < least * count) break;
    if (least > 0.0 && gripped == 0 && i == kHopeless) break;
    const Copy& copy = copies_[static_cast<size_t>(i)];
    if (!IsStable(copy, grasp)) continue;
    ++stable;
    if (IsHeld(copy, grasp, options.pushed ? copy.push : Push::kNone)) {
      ++gripped;
    }
  }
  return {static_cast<double>(stable) / count,
          static_cast<double>(gripped) / count};
}

double PerturbedCopies::CalcGripped(const Grasp& grasp, double least) {
  std::vector<Copy*> order;
  for (Copy& copy : copies_) order.push_back(&copy);
  const bool hard_first = least > kLargeShare;
  std::stable_sort(order.begin(), order.end(),
                   [hard_first](const Copy* a, const Copy* b) {
                     return hard_first ? a->times_lost > b->times_lost
                                       : a->times_lost < b->times_lost;
                   });
  const int count = static_cast<int>(order.size());
  int gripped = 0;
  for (int i = 0; i < count; ++i) {
    if (gripped + count - i < least * count) break;
    if (!hard_first && gripped == 0 && i == kHopeless) break;
    Copy& copy = *order[static_cast<size_t>(i)];
    // What is not held need not be stable.
    if (IsHeld(copy, grasp, copy.push) && IsStable(copy, grasp)) {
      ++gripped;
    } else {
      ++copy.times_lost;
    }
  }
  return static_cast<double>(gripped) / count;
}

Robustness CalcRobustness(const HandShape& hand, const Grasp& grasp,
                          const Solid& solid, const Parameters& parameters,
                          uint64_t seed, const RobustnessOptions& options) {
  return PerturbedCopies(hand, solid, parameters, seed, options.copies)
      .Judge(grasp, options);
}

}  // namespace graspdb
