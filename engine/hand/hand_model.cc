#include "engine/hand/hand_model.h"

#include <algorithm>
#include <utility>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

RigidTransform CalcJointMotion(const HandJoint& joint, double q) {
  if (joint.type == JointType::kPrismatic) {
    return {Eigen::Matrix3d::Identity(), q * joint.axis_J};
  }
  return {Eigen::AngleAxisd(q, joint.axis_J).toRotationMatrix(),
          Eigen::Vector3d::Zero()};
}

}  // namespace

HandModel::HandModel(Data data) : data_(std::move(data)) {
  GRASPDB_EXPECTS(!data_.links.empty() && data_.links[0].joint == -1);
  for (int i = 1; i < num_links(); ++i) {
    const HandLink& link = data_.links[i];
    GRASPDB_EXPECTS(link.joint >= 0 && link.joint < num_joints());
    GRASPDB_EXPECTS(link.parent >= 0 && link.parent < i);
  }
  for (int a = 0; a < num_links(); ++a) {
    for (int b = a + 1; b < num_links(); ++b) {
      const bool ignored = std::any_of(
          data_.ignored_collisions.begin(), data_.ignored_collisions.end(),
          [a, b](const std::pair<int, int>& pair) {
            return std::minmax(pair.first, pair.second) == std::minmax(a, b);
          });
      if (!ignored) self_collision_pairs_.emplace_back(a, b);
    }
  }
}

Eigen::VectorXd HandModel::CalcCoupledJoints(
    const Eigen::VectorXd& actuators) const {
  GRASPDB_EXPECTS(actuators.size() == num_actuators());
  Eigen::VectorXd q(num_joints());
  for (int j = 0; j < num_joints(); ++j) {
    const HandJoint& joint = data_.joints[j];
    q[j] = std::clamp(joint.ratio * actuators[joint.actuator], joint.lower,
                      joint.upper);
  }
  return q;
}

Eigen::VectorXd HandModel::CalcActuators(const Eigen::VectorXd& q) const {
  GRASPDB_EXPECTS(q.size() == num_joints());
  Eigen::VectorXd motors(num_actuators());
  for (int a = 0; a < num_actuators(); ++a) {
    const std::vector<int>& chain = data_.actuators[a].joints;
    motors[a] = q[chain[0]];
    // Travel of a released joint beyond its coupled position is motor travel
    // that the blocked joint did not make.
    for (size_t k = 1; k < chain.size(); ++k) {
      const HandJoint& joint = data_.joints[chain[k]];
      if (joint.breakaway_ratio > 0.0) {
        motors[a] += std::max(0.0, q[chain[k]] - joint.ratio * q[chain[0]]) /
                     joint.breakaway_ratio;
      }
    }
  }
  return motors;
}

std::vector<RigidTransform> CalcLinkPoses(const HandModel& hand,
                                          const Eigen::VectorXd& q) {
  std::vector<RigidTransform> X_HL;
  CalcLinkPoses(hand, q, X_HL);
  return X_HL;
}

void CalcLinkPoses(const HandModel& hand, const Eigen::VectorXd& q,
                   std::vector<RigidTransform>& X_HL) {
  GRASPDB_EXPECTS(q.size() == hand.num_joints());
  X_HL.resize(hand.num_links());
  X_HL[0] = {};
  for (int i = 1; i < hand.num_links(); ++i) {
    const HandLink& link = hand.links()[i];
    const HandJoint& joint = hand.joints()[link.joint];
    X_HL[i] =
        X_HL[link.parent] * joint.X_PJ * CalcJointMotion(joint, q[link.joint]);
  }
}

RigidTransform CalcLinkPose(const HandModel& hand, const Eigen::VectorXd& q,
                            int link) {
  RigidTransform X_HL;
  for (int i = link; i > 0; i = hand.links()[i].parent) {
    const HandJoint& joint = hand.joints()[hand.links()[i].joint];
    X_HL = joint.X_PJ * CalcJointMotion(joint, q[hand.links()[i].joint]) * X_HL;
  }
  return X_HL;
}

}  // namespace graspdb
