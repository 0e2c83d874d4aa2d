#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "engine/base/result.h"
#include "engine/geometry/triangle_mesh.h"
#include "engine/math/rigid_transform.h"

namespace graspdb {

/** A point on a link where grasps like to touch the object. */
struct HandContactPoint {
  int link{0};
  Eigen::Vector3d p_L{Eigen::Vector3d::Zero()};      ///< In link frame L, m.
  Eigen::Vector3d nhat_L{Eigen::Vector3d::UnitZ()};  ///< Out of the hand.
};

/** A rigid body of the hand. */
struct HandLink {
  std::string name;
  int joint{-1};   ///< The joint that moves it; -1 for the base.
  int parent{-1};  ///< Parent link; -1 for the base.
  std::vector<TriangleMesh> pieces_L;  ///< Convex closed pieces, frame L.
  double mass{0.0};                    ///< kg.
  Eigen::Vector3d p_LcCM{Eigen::Vector3d::Zero()};  ///< Mass centre in L, m.
};

enum class JointType { kRevolute, kPrismatic };

/** A joint between a parent link P and its child link L:
 X_PL(q) = X_PJ · Motion(axis_J, q). */
struct HandJoint {
  std::string name;
  JointType type{JointType::kRevolute};
  int parent_link{0};
  int child_link{0};
  RigidTransform X_PJ;  ///< Joint frame at q = 0, in the parent link.
  Eigen::Vector3d axis_J{Eigen::Vector3d::UnitZ()};
  double lower{0.0};  ///< rad or m.
  double upper{0.0};  ///< rad or m.
  int actuator{-1};   ///< Index into HandModel::actuators().
  double ratio{1.0};  ///< q = ratio · (its actuator's position) when coupled.
  /** After the joint before it on the same actuator is blocked, this joint goes
   on at this multiple of the actuator's travel; 0 when it cannot. */
  double breakaway_ratio{0.0};

  /** As its actuator closes, which is upwards: 1, or -1 if it mimics backwards.
   */
  double closing_sign() const { return ratio < 0.0 ? -1.0 : 1.0; }
  /** Where it ends then, rad or m. */
  double closing_limit() const { return ratio < 0.0 ? lower : upper; }
};

/** A motor: one or more coupled joints, proximal first. */
struct HandActuator {
  std::string name;
  std::vector<int> joints;  ///< Proximal to distal; the first has ratio 1.
  bool closes{false};       ///< Closes the hand as its position grows.
  double lower{0.0};        ///< Range of the first joint, rad or m.
  double upper{0.0};
};

/** An articulated hand: a tree of links in topological order, link 0 the base
 whose frame is H. Immutable; shared by all threads. Built by MakeHand(). */
class HandModel {
 public:
  struct Data {
    std::string name;
    std::vector<HandLink> links;
    std::vector<HandJoint> joints;
    std::vector<HandActuator> actuators;
    std::vector<HandContactPoint> contact_points;
    std::vector<std::pair<int, int>> ignored_collisions;
    Eigen::Vector3d approach_H{Eigen::Vector3d::UnitZ()};
    double closing_force{15.0};
  };

  /** @pre Links are in topological order, indices in range. */
  explicit HandModel(Data data);

  const std::string& name() const { return data_.name; }
  const std::vector<HandLink>& links() const { return data_.links; }
  const std::vector<HandJoint>& joints() const { return data_.joints; }
  const std::vector<HandActuator>& actuators() const { return data_.actuators; }
  const std::vector<HandContactPoint>& contact_points() const {
    return data_.contact_points;
  }
  /** The hand's direction of motion when it approaches, unit, in H. */
  const Eigen::Vector3d& approach_H() const { return data_.approach_H; }
  /** Newtons at a fingertip when it has closed. */
  double closing_force() const { return data_.closing_force; }
  int num_links() const { return static_cast<int>(data_.links.size()); }
  int num_joints() const { return static_cast<int>(data_.joints.size()); }
  int num_actuators() const { return static_cast<int>(data_.actuators.size()); }
  /** Link pairs (a < b) that are to be tested for self-collision. */
  const std::vector<std::pair<int, int>>& self_collision_pairs() const {
    return self_collision_pairs_;
  }

  /** Joint positions of an actuator vector when nothing blocks: q = ratio · m,
   clamped to each joint's limits. */
  Eigen::VectorXd CalcCoupledJoints(const Eigen::VectorXd& actuators) const;
  /** The motors' positions that lead to q; for a finger that broke away, the
   travel of the blocked and the released joint together (for the Barrett hand
   3/4 (J2 + J3)). */
  Eigen::VectorXd CalcActuators(const Eigen::VectorXd& q) const;

 private:
  Data data_;
  std::vector<std::pair<int, int>> self_collision_pairs_;
};

/** A hand's pose in the object frame O and its joints q (all of them). */
struct HandConfiguration {
  RigidTransform X_OH;
  Eigen::VectorXd q;

  bool operator==(const HandConfiguration&) const = default;
};

/** X_HL of every link, in the model's order. @pre q.size() == num_joints(). */
std::vector<RigidTransform> CalcLinkPoses(const HandModel& hand,
                                          const Eigen::VectorXd& q);
/** The same for loops: asks for no memory once X_HL has been used. */
void CalcLinkPoses(const HandModel& hand, const Eigen::VectorXd& q,
                   std::vector<RigidTransform>& X_HL);

/** X_HL of one link. @pre q.size() == num_joints(). */
RigidTransform CalcLinkPose(const HandModel& hand, const Eigen::VectorXd& q,
                            int link);

}  // namespace graspdb
