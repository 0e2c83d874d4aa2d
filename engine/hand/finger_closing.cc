#include "engine/hand/finger_closing.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// A link stops this far from the surface, as the distance field estimates it,
// and no step is shorter, metres.
constexpr double kContactGap = 0.0001;
// Should the exact test then find a collision, the link backs off by this much
// at a time, metres of motion.
constexpr double kBackOff = 0.0001;
// Moments of self-collision are found to this motion, metres.
constexpr double kContactMotion = 0.00003;
// Fingers, about 20 mm thick, are tested against each other at least this
// often, metres of motion.
constexpr double kSelfCollisionStep = 0.010;

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
              const Solid& solid, int actuator, Eigen::VectorXd q)
      : hand_(hand),
        model_(hand.model()),
        X_OH_(X_OH),
        solid_(solid),
        actuator_(actuator),
        chain_(model_.actuators()[actuator].joints),
        q_(std::move(q)),
        speed_(chain_.size()) {}

  FingerPath Run() {
    AddKnot();
    while (UpdateSpeeds()) {
      const double limit = FindLimitStep();
      const Step step = FindStep();
      if (step.travel >= limit && step.touching < 0) {
        Advance(limit);
        break;
      }
      if (step.touching < 0) {
        Advance(step.travel);
        continue;
      }
      BackOff();
      AddKnot();
      blocked_ = step.touching + 1;
    }
    AddKnot();
    return std::move(path_);
  }

 private:
  // Sets each joint's speed per motor travel; false when nothing moves.
  bool UpdateSpeeds() {
    bool moving = false;
    for (int k = 0; k < static_cast<int>(chain_.size()); ++k) {
      const HandJoint& joint = model_.joints()[chain_[k]];
      const double ratio = blocked_ == 0 ? joint.ratio : joint.breakaway_ratio;
      speed_[k] = k < blocked_ ? 0.0 : ratio;
      moving = moving || speed_[k] > 0.0;
    }
    return moving;
  }

  // Motor travel until the first joint limit.
  double FindLimitStep() const {
    double travel = std::numeric_limits<double>::infinity();
    for (size_t k = 0; k < chain_.size(); ++k) {
      if (speed_[k] > 0.0) {
        travel = std::min(
            travel,
            (model_.joints()[chain_[k]].upper - q_[chain_[k]]) / speed_[k]);
      }
    }
    return std::max(0.0, travel);
  }

  struct Step {
    double travel{0.0};  // Motor travel that leads no link to the object.
    int touching{-1};    // The most proximal moving joint whose link touches.
  };

  Step FindStep() {
    const std::vector<RigidTransform> X_HL = CalcLinkPoses(model_, q_);
    Step step{std::numeric_limits<double>::infinity(), -1};
    speed_bound_ = 0.0;
    for (int k = blocked_; k < static_cast<int>(chain_.size()); ++k) {
      double speed = 0.0;
      for (const int link : hand_.chain_links(actuator_, k)) {
        if (!hand_.link(link)) continue;
        for (int i = 0; i <= k; ++i) {
          speed += speed_[i] * hand_.motion_bound(link, chain_[i]);
        }
        if (speed == 0.0) continue;
        const double gap =
            EstimateGap(*hand_.link(link), X_OH_ * X_HL[link], solid_);
        if (gap <= 2.0 * kContactGap && step.touching < 0) step.touching = k;
        step.travel = std::min(
            step.travel, std::max(gap - kContactGap, kContactGap) / speed);
      }
      speed_bound_ = std::max(speed_bound_, speed);
    }
    return step;
  }

  bool Collides() const {
    const std::vector<RigidTransform> X_HL = CalcLinkPoses(model_, q_);
    for (int k = blocked_; k < static_cast<int>(chain_.size()); ++k) {
      for (const int link : hand_.chain_links(actuator_, k)) {
        if (hand_.link(link) &&
            LinkCollides(*hand_.link(link), X_OH_ * X_HL[link], solid_)) {
          return true;
        }
      }
    }
    return false;
  }

  // Until the exact test finds the moving links free; to the last knot at most,
  // which is known to be.
  void BackOff() {
    const double known = path_.knots.back().travel;
    for (double back = kBackOff / speed_bound_; travel_ > known && Collides();
         back *= 2.0) {
      Advance(std::max(-back, known - travel_));
    }
  }

  void Advance(double travel) {
    for (size_t k = 0; k < chain_.size(); ++k) {
      q_[chain_[k]] += speed_[k] * travel;
    }
    travel_ += travel;
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
  Eigen::VectorXd q_;
  std::vector<double> speed_;
  double speed_bound_{0.0};  // Of the links, metres per motor travel.
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

  // Stops fingers where they meet each other or the palm.
  void StopAtSelfCollisions() {
    double end = 0.0;
    double speed = 0.0;
    for (const Finger& finger : fingers_) {
      end = std::max(end, finger.stop);
      for (int link = 0; link < hand_.model().num_links(); ++link) {
        double bound = 0.0;
        for (const int j : hand_.model().actuators()[finger.actuator].joints) {
          bound += hand_.motion_bound(link, j);
        }
        speed = std::max(speed, bound);
      }
    }
    if (speed == 0.0 || end == 0.0) return;
    const double step = kSelfCollisionStep / speed;
    double free = 0.0;
    while (free < end) {
      const double travel = std::min(end, free + step);
      if (!FindCollision(travel)) {
        free = travel;
        continue;
      }
      double low = free;
      double high = travel;
      while ((high - low) * speed > kContactMotion) {
        const double middle = 0.5 * (low + high);
        (FindCollision(middle) ? high : low) = middle;
      }
      const auto pair = FindCollision(high);
      const bool stopped = Stop(pair->first, low) | Stop(pair->second, low);
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

  std::optional<std::pair<int, int>> FindCollision(double travel) const {
    return FindSelfCollision(hand_,
                             CalcLinkPoses(hand_.model(), CalcJoints(travel)));
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
};

}  // namespace

Eigen::VectorXd CloseFingers(const HandShape& hand, const RigidTransform& X_OH,
                             const Eigen::VectorXd& q_start,
                             const Solid& solid) {
  const HandModel& model = hand.model();
  GRASPDB_EXPECTS(q_start.size() == model.num_joints());
  HandMotion motion(hand, q_start);
  for (int a = 0; a < model.num_actuators(); ++a) {
    if (!model.actuators()[a].closes) continue;
    motion.AddFinger(a, FingerMarch(hand, X_OH, solid, a, q_start).Run());
  }
  motion.StopAtSelfCollisions();
  return motion.CalcJoints(std::numeric_limits<double>::infinity());
}

}  // namespace graspdb
