#include "engine/reference/fcl_hand.h"

#include <algorithm>
#include <cmath>

namespace graspdb {
namespace {

constexpr double kStep = 0.5 * M_PI / 180.0;  // rad
constexpr int kBisections = 8;

bool LinkMeets(const HandShape& hand, int link, const RigidTransform& X_OL,
               const Solid& solid) {
  return hand.link(link) &&
         solid.shape().IntersectsByFcl(hand.link(link)->shape, X_OL);
}

// Whether any link from the k-th joint of an actuator's chain on meets it.
bool ChainMeets(const HandShape& hand, int actuator, size_t first,
                const RigidTransform& X_OH, const Eigen::VectorXd& q,
                const Solid& solid) {
  const auto& joints =
      hand.model().actuators()[static_cast<size_t>(actuator)].joints;
  for (size_t k = first; k < joints.size(); ++k) {
    for (const int link : hand.chain_links(actuator, static_cast<int>(k))) {
      if (LinkMeets(hand, link, X_OH * CalcLinkPose(hand.model(), q, link),
                    solid)) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

int FindCollidingLinkByFcl(const HandShape& hand, const RigidTransform& X_OH,
                           const std::vector<RigidTransform>& X_HL,
                           const Solid& solid) {
  for (int link = 0; link < hand.model().num_links(); ++link) {
    if (LinkMeets(hand, link, X_OH * X_HL[static_cast<size_t>(link)], solid)) {
      return link;
    }
  }
  return -1;
}

bool CollidesWithItselfByFcl(const HandShape& hand,
                             const std::vector<RigidTransform>& X_HL) {
  for (const auto& [a, b] : hand.model().self_collision_pairs()) {
    if (!hand.link(a) || !hand.link(b)) continue;
    const RigidTransform X_AB =
        X_HL[static_cast<size_t>(a)].Inverse() * X_HL[static_cast<size_t>(b)];
    if (hand.link(a)->shape.IntersectsByFcl(hand.link(b)->shape, X_AB))
      return true;
  }
  return false;
}

double CalcDistanceByFcl(const HandShape& hand, const RigidTransform& X_OH,
                         const std::vector<RigidTransform>& X_HL,
                         const Solid& solid) {
  double least = 1e300;
  for (int link = 0; link < hand.model().num_links(); ++link) {
    if (!hand.link(link)) continue;
    least = std::min(least, solid.shape().CalcDistance(
                                hand.link(link)->shape,
                                X_OH * X_HL[static_cast<size_t>(link)]));
  }
  return least;
}

Eigen::VectorXd CloseFingersByFcl(const HandShape& hand,
                                  const RigidTransform& X_OH,
                                  const Eigen::VectorXd& q_start,
                                  const Solid& solid) {
  const HandModel& model = hand.model();
  Eigen::VectorXd q = q_start;
  for (int a = 0; a < model.num_actuators(); ++a) {
    const HandActuator& actuator = model.actuators()[static_cast<size_t>(a)];
    if (!actuator.closes) continue;
    for (size_t first = 0; first < actuator.joints.size(); ++first) {
      // The motor turns all joints from the first that is not blocked.
      const auto turned = [&](const Eigen::VectorXd& from, double travel) {
        Eigen::VectorXd to = from;
        for (size_t k = first; k < actuator.joints.size(); ++k) {
          const int j = actuator.joints[k];
          const HandJoint& joint = model.joints()[static_cast<size_t>(j)];
          const double ratio =
              first > 0 && k == first ? joint.breakaway_ratio : joint.ratio;
          to[j] =
              std::clamp(from[j] + ratio * travel, joint.lower, joint.upper);
        }
        return to;
      };
      bool met = false;
      while (!met) {
        const Eigen::VectorXd next = turned(q, kStep);
        if (next == q) break;
        met = ChainMeets(hand, a, first, X_OH, next, solid);
        if (!met) q = next;
      }
      double low = 0.0;
      double high = kStep;
      for (int i = 0; met && i < kBisections; ++i) {
        const double middle = 0.5 * (low + high);
        const bool meets =
            ChainMeets(hand, a, first, X_OH, turned(q, middle), solid);
        (meets ? high : low) = middle;
      }
      if (met) q = turned(q, low);
    }
  }
  return q;
}

}  // namespace graspdb
