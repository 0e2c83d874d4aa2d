#include "engine/hand/hand_sweep.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace graspdb {
namespace {

// The contact is found to this motion, metres.
constexpr double kContactMotion = 0.00002;
// The hand, its links about 20 mm thick, is tested against itself this often,
// metres of finger motion.
constexpr double kSelfCollisionStep = 0.010;

class Sweep {
 public:
  Sweep(const HandShape& hand, const HandConfiguration& from,
        const HandConfiguration& to, const Solid& solid, double fine_step)
      : hand_(hand),
        from_(from),
        to_(to),
        solid_(solid),
        fine_step_(fine_step) {
    const double turn =
        CalcRotationAngle(from.X_OH.rotation.transpose() * to.X_OH.rotation);
    const double travel = (to.X_OH.translation - from.X_OH.translation).norm();
    for (int i = 0; i < hand.model().num_links(); ++i) {
      double finger = 0.0;
      for (int j = 0; j < hand.model().num_joints(); ++j) {
        finger += std::abs(to.q[j] - from.q[j]) * hand.motion_bound(i, j);
      }
      finger_speed_ = std::max(finger_speed_, finger);
      speed_.push_back(travel + turn * hand.reach(i) + finger);
    }
    max_speed_ = *std::max_element(speed_.begin(), speed_.end());
  }

  double Run() {
    double t = 0.0;
    while (t < 1.0) {
      const double step = FindCertainStep(t);
      const double next = std::min(1.0, t + step);
      if (!MeetsSolid(next) && !MeetsItself(next)) {
        t = next;
        continue;
      }
      return Bisect(t, next);
    }
    return 1.0;
  }

 private:
  // The share of the way that no link can meet the solid in; or a fine step,
  // not proven for the links in near_.
  double FindCertainStep(double t) {
    near_.clear();
    const HandConfiguration here = Interpolate(from_, to_, t);
    const auto X_HL = CalcLinkPoses(hand_.model(), here.q);
    double step =
        finger_speed_ > 0.0 ? kSelfCollisionStep / finger_speed_ : 1.0;
    for (int i = 0; i < hand_.model().num_links(); ++i) {
      if (!hand_.link(i) || speed_[i] == 0.0) continue;
      const double gap =
          CalcGapBound(*hand_.link(i), here.X_OH * X_HL[i], solid_, fine_step_);
      if (gap < fine_step_) near_.push_back(i);
      step = std::min(step, std::max(gap, fine_step_) / speed_[i]);
    }
    return step;
  }

  bool MeetsSolid(double t) const {
    if (near_.empty()) return false;
    const HandConfiguration here = Interpolate(from_, to_, t);
    const auto X_HL = CalcLinkPoses(hand_.model(), here.q);
    return std::any_of(near_.begin(), near_.end(), [&](int i) {
      return LinkCollides(*hand_.link(i), here.X_OH * X_HL[i], solid_);
    });
  }

  bool MeetsItself(double t) const {
    return finger_speed_ > 0.0 &&
           FindSelfCollision(hand_, CalcLinkPoses(hand_.model(),
                                                  Interpolate(from_, to_, t).q))
               .has_value();
  }

  double Bisect(double low, double high) const {
    while ((high - low) * max_speed_ > kContactMotion) {
      const double middle = 0.5 * (low + high);
      (MeetsSolid(middle) || MeetsItself(middle) ? high : low) = middle;
    }
    return low;
  }

  const HandShape& hand_;
  const HandConfiguration& from_;
  const HandConfiguration& to_;
  const Solid& solid_;
  const double fine_step_;
  std::vector<double> speed_;  // Per link, metres over the whole way.
  double max_speed_{0.0};
  double finger_speed_{0.0};
  std::vector<int> near_;  // Links whose gap is not proven.
};

}  // namespace

HandConfiguration Interpolate(const HandConfiguration& from,
                              const HandConfiguration& to, double t) {
  const Eigen::AngleAxisd turn(from.X_OH.rotation.transpose() *
                               to.X_OH.rotation);
  HandConfiguration result;
  result.X_OH.rotation =
      from.X_OH.rotation *
      Eigen::AngleAxisd(t * turn.angle(), turn.axis()).toRotationMatrix();
  result.X_OH.translation =
      (1.0 - t) * from.X_OH.translation + t * to.X_OH.translation;
  result.q = (1.0 - t) * from.q + t * to.q;
  return result;
}

double FindFirstContact(const HandShape& hand, const HandConfiguration& from,
                        const HandConfiguration& to, const Solid& solid,
                        double fine_step) {
  return Sweep(hand, from, to, solid, fine_step).Run();
}

}  // namespace graspdb
