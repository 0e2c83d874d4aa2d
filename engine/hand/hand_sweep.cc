#include "engine/hand/hand_sweep.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace graspdb {
namespace {

// The contact is found to this motion, metres.
constexpr double kContactMotion = 0.00002;

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
      finger_speed_.push_back(finger);
      speed_.push_back(travel + turn * hand.reach(i) + finger);
    }
    max_speed_ = *std::max_element(speed_.begin(), speed_.end());
    for (const auto& [a, b] : hand.model().self_collision_pairs()) {
      const double speed = finger_speed_[a] + finger_speed_[b];
      if (hand.link(a) && hand.link(b) && speed > 0.0) {
        pairs_.push_back({a, b, speed, 0.0});
      }
    }
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
  // Two links that move against each other.
  struct LinkPair {
    int a, b;
    double speed;           // At most, metres over the whole way.
    double certainly_free;  // The share of the way up to which they are.
  };

  // The share of the way that nothing can meet anything in; or a fine step, not
  // proven for the links in near_ and the pairs in near_pairs_.
  double FindCertainStep(double t) {
    near_.clear();
    const HandConfiguration here = Interpolate(from_, to_, t);
    const auto X_HL = CalcLinkPoses(hand_.model(), here.q);
    double step = 1.0;
    for (int i = 0; i < hand_.model().num_links(); ++i) {
      if (!hand_.link(i) || speed_[i] == 0.0) continue;
      const double gap = CalcGapBound(*hand_.link(i), here.X_OH * X_HL[i],
                                      solid_, {.enough = fine_step_});
      if (gap < fine_step_) near_.push_back(i);
      step = std::min(step, std::max(gap, fine_step_) / speed_[i]);
    }
    near_pairs_.clear();
    for (LinkPair& pair : pairs_) {
      const double fine = fine_step_ / pair.speed;
      if (pair.certainly_free < t + fine) {
        const double gap = CalcLinkGapBound(hand_, pair.a, pair.b, X_HL,
                                            {.enough = fine_step_});
        if (gap < fine_step_) near_pairs_.push_back(pair);
        pair.certainly_free = t + std::max(gap / pair.speed, fine);
      }
      step = std::min(step, pair.certainly_free - t);
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
    if (near_pairs_.empty()) return false;
    const auto X_HL =
        CalcLinkPoses(hand_.model(), Interpolate(from_, to_, t).q);
    return std::any_of(near_pairs_.begin(), near_pairs_.end(),
                       [&](const LinkPair& pair) {
                         return LinksCollide(hand_, pair.a, pair.b, X_HL);
                       });
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
  std::vector<double> finger_speed_;  // The same, against the palm.
  std::vector<LinkPair> pairs_;
  std::vector<int> near_;             // Links whose gap is not proven …
  std::vector<LinkPair> near_pairs_;  // … and pairs of them.
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
