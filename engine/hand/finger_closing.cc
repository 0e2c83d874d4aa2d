#include "engine/hand/finger_closing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// A link stops this far from the surface, as the distance field estimates it,
// and no step is shorter, metres.
constexpr double kContactGap = 0.0001;
// Should the exact test then find a collision, the link backs off by this much
// at a time, metres of motion.
constexpr double kBackOff = 0.0001;
// A link may run so far into the object before the march turns back: less than
// the thinnest wall, so that none is passed through, metres.
constexpr double kOvershoot = 0.001;
// Where a finger meets the object is found to this motion, metres; where it
// meets another one, less matters, and least to estimates.
constexpr double kContactMotion = 0.00003;
constexpr double kSelfContactMotion = 0.0001;
constexpr double kRoughSelfContactMotion = 0.0005;
// Fingers, about 20 mm thick, are tested against each other at least this
// often, metres of motion; estimates may miss one that cuts a corner.
constexpr double kSelfCollisionStep = 0.010;
constexpr double kRoughSelfCollisionStep = 0.040;

// A finger that stands in the solid draws back by this motor travel first.
constexpr double kRetreatStep = 0.002;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A finger's joints as a function of its motor's travel: linear between knots.
struct FingerPath {
  struct Knot {
    double travel{0.0};
    std::vector<double> joints;  // In the chain's order.
  };
  std::vector<Knot> knots;

  double length() const { return knots.back().travel; }

  void Apply(double travel, const std::vector<int>& chain,
             Eigen::VectorXd& q) const {
    const auto after = std::find_if(
        knots.begin(), knots.end(),
        [travel](const Knot& knot) { return knot.travel >= travel; });
    if (after == knots.begin() || after == knots.end()) {
      const Knot& knot = after == knots.end() ? knots.back() : *after;
      for (size_t k = 0; k < chain.size(); ++k) q[chain[k]] = knot.joints[k];
      return;
    }
    const Knot& before = *(after - 1);
    const double t = (travel - before.travel) / (after->travel - before.travel);
    for (size_t k = 0; k < chain.size(); ++k) {
      q[chain[k]] =
          before.joints[k] + t * (after->joints[k] - before.joints[k]);
    }
  }
};

// Marches one finger against the object, as if the others were not there.
class FingerMarch {
 public:
  FingerMarch(const HandShape& hand, const RigidTransform& X_OH,
              const Solid& solid, int actuator, const Eigen::VectorXd& q,
              Precision precision)
      : hand_(hand),
        model_(hand.model()),
        X_OH_(X_OH),
        solid_(solid),
        actuator_(actuator),
        chain_(model_.actuators()[actuator].joints),
        precision_(precision),
        q_(q),
        speed_(chain_.size()) {}

  FingerPath Run() {
    AddKnot();
    while (StartPhase()) {
      const int touching = MarchToContact(travel_ + FindLimitStep());
      // At the end of the way, too: the estimate may have seen no contact.
      if (precision_ == Precision::kExact) BackOff();
      if (touching < 0) break;
      AddKnot();
      blocked_ = touching + 1;
    }
    AddKnot();
    return std::move(path_);
  }

 private:
  // A link that moves in this phase.
  struct Mover {
    int link;
    int k;                  // The chain's joint that carries it.
    double speed;           // At most, metres per motor travel.
    double known_free;      // The last motor travel at which it was seen free.
    double certainly_free;  // And the one up to which it must be looked at.
  };

  // Sets each joint's speed per motor travel; false when nothing moves.
  bool StartPhase() {
    for (size_t k = 0; k < chain_.size(); ++k) {
      const HandJoint& joint = model_.joints()[chain_[k]];
      const double ratio = blocked_ == 0 ? joint.ratio : joint.breakaway_ratio;
      speed_[k] = static_cast<int>(k) < blocked_ ? 0.0 : ratio;
    }
    movers_.clear();
    for (int k = blocked_; k < static_cast<int>(chain_.size()); ++k) {
      for (const int link : hand_.chain_links(actuator_, k)) {
        if (!hand_.link(link)) continue;
        double speed = 0.0;
        for (int i = 0; i <= k; ++i) {
          speed += std::abs(speed_[i]) * hand_.motion_bound(link, chain_[i]);
        }
        if (speed > 0.0) movers_.push_back({link, k, speed, travel_, travel_});
      }
    }
    return !movers_.empty();
  }

  // Motor travel until the first joint limit.
  double FindLimitStep() const {
    double travel = kInfinity;
    for (size_t k = 0; k < chain_.size(); ++k) {
      if (speed_[k] == 0.0) continue;
      const HandJoint& joint = model_.joints()[chain_[k]];
      travel =
          std::min(travel, (joint.closing_limit() - q_[chain_[k]]) / speed_[k]);
    }
    return std::max(0.0, travel);
  }

  // Moves on until a link touches; the joint that carries it, or -1 at the end.
  // Each link is looked at only when it may have come near.
  int MarchToContact(double end) {
    while (true) {
      Mover& next = *std::min_element(
          movers_.begin(), movers_.end(), [](const Mover& a, const Mover& b) {
            return a.certainly_free < b.certainly_free;
          });
      const bool at_end = next.certainly_free >= end;
      MoveTo(at_end ? end : next.certainly_free);
      const double gap = CalcGap(next);
      if (gap > kContactGap) {
        if (at_end) return -1;
        next.known_free = travel_;
        next.certainly_free = travel_ + (gap + kOvershoot) / next.speed;
        continue;
      }
      FindContact(next, gap);
      int k = next.k;
      for (const Mover& other : movers_) {
        if (other.k < k && CalcGap(other) <= 2.0 * kContactGap) k = other.k;
      }
      return k;
    }
  }

  // Between where the link was free and here, where it touches or has gone too
  // far: the travel at which it touches. Regula falsi, Illinois variant.
  void FindContact(const Mover& mover, double gap) {
    double low = mover.known_free, high = travel_;
    double excess_low = 0.0, excess_high = gap - kContactGap;
    if (gap < 0.0 && low < high) {
      MoveTo(low);
      excess_low = CalcGap(mover) - kContactGap;
      for (int side = 0;
           (high - low) * mover.speed > kContactMotion && excess_low > 0.0;) {
        const double share = excess_low / (excess_low - excess_high);
        MoveTo(low + std::clamp(share, 0.05, 0.95) * (high - low));
        const double excess = CalcGap(mover) - kContactGap;
        if (std::abs(excess) <= 0.5 * kContactGap) return;
        if (excess > 0.0) {
          low = travel_;
          excess_low = excess;
          if (side == 1) excess_high *= 0.5;
          side = 1;
        } else {
          high = travel_;
          excess_high = excess;
          if (side == -1) excess_low *= 0.5;
          side = -1;
        }
      }
      MoveTo(low);
    }
  }

  double CalcGap(const Mover& mover) const {
    return EstimateGap(*hand_.link(mover.link),
                       X_OH_ * CalcLinkPose(model_, q_, mover.link), solid_);
  }

  bool Collides() const {
    return std::any_of(
        movers_.begin(), movers_.end(), [this](const Mover& mover) {
          return LinkCollides(*hand_.link(mover.link),
                              X_OH_ * CalcLinkPose(model_, q_, mover.link),
                              solid_);
        });
  }

  // To where the exact test finds the moving links free, but not by more than
  // kBackOff; to the last knot at most, which is known to be free.
  void BackOff() {
    double speed = 0.0;
    for (const Mover& mover : movers_) speed = std::max(speed, mover.speed);
    const double step = kBackOff / speed;
    const double known = path_.knots.back().travel;
    double colliding = travel_;
    for (double back = step; travel_ > known && Collides(); back *= 2.0) {
      colliding = travel_;
      MoveTo(std::max(known, travel_ - back));
    }
    double free = travel_;
    while (colliding - free > step) {
      MoveTo(0.5 * (free + colliding));
      (Collides() ? colliding : free) = travel_;
    }
    MoveTo(free);
  }

  void MoveTo(double travel) {
    for (size_t k = 0; k < chain_.size(); ++k) {
      q_[chain_[k]] += speed_[k] * (travel - travel_);
    }
    travel_ = travel;
  }

  void AddKnot() {
    FingerPath::Knot knot{travel_, {}};
    for (const int joint : chain_) knot.joints.push_back(q_[joint]);
    path_.knots.push_back(std::move(knot));
  }

  const HandShape& hand_;
  const HandModel& model_;
  const RigidTransform& X_OH_;
  const Solid& solid_;
  const int actuator_;
  const std::vector<int>& chain_;
  const Precision precision_;
  Eigen::VectorXd q_;
  std::vector<double> speed_;
  std::vector<Mover> movers_;
  double travel_{0.0};
  int blocked_{0};  // So many joints of the chain have stopped.
  FingerPath path_;
};

// The fingers of one hand, moving together along their paths.
class HandMotion {
 public:
  HandMotion(const HandShape& hand, const Eigen::VectorXd& q_start)
      : hand_(hand), q_start_(q_start) {}

  void AddFinger(int actuator, FingerPath path) {
    fingers_.push_back({actuator, path.length(), std::move(path)});
  }

  Eigen::VectorXd CalcJoints(double travel) const {
    Eigen::VectorXd q = q_start_;
    for (const Finger& finger : fingers_) {
      finger.path.Apply(std::min(travel, finger.stop),
                        hand_.model().actuators()[finger.actuator].joints, q);
    }
    return q;
  }

  // Draws back fingers that stand in the solid: one that met another finger may
  // have been stopped on its way through something thin.
  void RetreatFrom(const Solid& solid, const RigidTransform& X_OH) {
    for (Finger& finger : fingers_) {
      const HandActuator& actuator = hand_.model().actuators()[finger.actuator];
      const auto collides = [&] {
        const auto X_HL = CalcLinkPoses(hand_.model(), CalcJoints(kInfinity));
        for (size_t k = 0; k < actuator.joints.size(); ++k) {
          for (const int i :
               hand_.chain_links(finger.actuator, static_cast<int>(k))) {
            if (hand_.link(i) &&
                LinkCollides(*hand_.link(i), X_OH * X_HL[i], solid)) {
              return true;
            }
          }
        }
        return false;
      };
      for (double back = kRetreatStep; finger.stop > 0.0 && collides();
           back *= 2.0) {
        finger.stop = std::max(0.0, finger.stop - back);
      }
    }
  }

  // Stops fingers where they meet each other or the palm.
  void StopAtSelfCollisions(double max_step, double tolerance) {
    double end = 0.0;
    double speed = 0.0;
    for (const Finger& finger : fingers_) {
      end = std::max(end, finger.stop);
      for (int link = 0; link < hand_.model().num_links(); ++link) {
        double bound = 0.0;
        for (const int j : hand_.model().actuators()[finger.actuator].joints) {
          bound += std::max(1.0, std::abs(hand_.model().joints()[j].ratio)) *
                   hand_.motion_bound(link, j);
        }
        speed = std::max(speed, bound);
      }
    }
    if (speed == 0.0 || end == 0.0) return;
    const double step = max_step / speed;
    double free = 0.0;
    while (free < end) {
      const double travel = std::min(end, free + step);
      if (!FindCollision(travel)) {
        free = travel;
        continue;
      }
      double low = free;
      double high = travel;
      while ((high - low) * speed > tolerance) {
        const double middle = 0.5 * (low + high);
        (FindCollision(middle) ? high : low) = middle;
      }
      const auto [a, b] = *FindCollision(high);
      const bool stopped = Stop(a, low) | Stop(b, low);
      // Fingers that started in collision can go no further.
      if (!stopped) return;
    }
  }

 private:
  struct Finger {
    int actuator;
    double stop;  // Motor travel at which it stands still.
    FingerPath path;
  };

  // The pair of links that collides at a motor travel, if any does.
  std::optional<std::pair<int, int>> FindCollision(double travel) {
    CalcLinkPoses(hand_.model(), CalcJoints(travel), X_HL_);
    return FindSelfCollision(hand_, X_HL_);
  }

  // Stops the finger that the link belongs to, if it still moves.
  bool Stop(int link, double travel) {
    for (Finger& finger : fingers_) {
      const int groups = static_cast<int>(
          hand_.model().actuators()[finger.actuator].joints.size());
      for (int k = 0; k < groups; ++k) {
        const std::vector<int>& links = hand_.chain_links(finger.actuator, k);
        if (std::find(links.begin(), links.end(), link) == links.end()) {
          continue;
        }
        if (finger.stop <= travel) return false;
        finger.stop = travel;
        return true;
      }
    }
    return false;
  }

  const HandShape& hand_;
  const Eigen::VectorXd& q_start_;
  std::vector<Finger> fingers_;
  std::vector<RigidTransform> X_HL_;
};

}  // namespace

Eigen::VectorXd CloseFingers(const HandShape& hand, const RigidTransform& X_OH,
                             const Eigen::VectorXd& q_start, const Solid& solid,
                             Precision precision) {
  const HandModel& model = hand.model();
  GRASPDB_EXPECTS(q_start.size() == model.num_joints());
  HandMotion motion(hand, q_start);
  for (int a = 0; a < model.num_actuators(); ++a) {
    if (!model.actuators()[a].closes) continue;
    motion.AddFinger(
        a, FingerMarch(hand, X_OH, solid, a, q_start, precision).Run());
  }
  if (precision == Precision::kExact) {
    motion.StopAtSelfCollisions(kSelfCollisionStep, kSelfContactMotion);
    motion.RetreatFrom(solid, X_OH);
  } else {
    motion.StopAtSelfCollisions(kRoughSelfCollisionStep,
                                kRoughSelfContactMotion);
  }
  return motion.CalcJoints(kInfinity);
}

}  // namespace graspdb
