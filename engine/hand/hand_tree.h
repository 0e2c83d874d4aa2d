#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/base/result.h"
#include "engine/hand/hand_model.h"
#include "engine/math/rigid_transform.h"

namespace graspdb {

/** What a URDF says of a hand, as plain values: a tree of links, each but the
 first moved by a joint against its parent. */
struct HandTree {
  /** A convex collision mesh M of a link. */
  struct Piece {
    std::string mesh;  ///< As the URDF names it.
    RigidTransform X_LM;
    bool operator==(const Piece&) const = default;
  };
  struct Joint {
    std::string name;
    JointType type{JointType::kRevolute};
    RigidTransform X_PJ;  ///< At q = 0, in the parent link.
    Eigen::Vector3d axis_J{Eigen::Vector3d::UnitZ()};  ///< Unit.
    double lower{0.0};                                 ///< rad or m.
    double upper{0.0};                                 ///< rad or m.
    std::string mimicked;  ///< The joint that it follows; empty: none.
    double ratio{1.0};     ///< q = ratio · q of the mimicked joint.
    bool operator==(const Joint&) const = default;
  };
  struct Link {
    std::string name;
    int parent{-1};    ///< An earlier link; -1 for the first.
    Joint joint;       ///< To the parent; of no account for the first.
    double mass{0.0};  ///< kg.
    Eigen::Vector3d p_LcCM{Eigen::Vector3d::Zero()};  ///< m.
    std::vector<Piece> pieces;
    bool operator==(const Link&) const = default;
  };
  std::vector<Link> links;
  bool operator==(const HandTree&) const = default;
};

/** What is wrong with a hand's URDF or what goes with it: kUnusableInput. */
Error MakeHandError(const std::string& what, std::string hint = "",
                    std::string field = "urdf");

/** Whether this can be a hand, whoever wrote it: 1 to 64 links and 1 to 64
 pieces, names that tell links and joints apart, parents before children, finite
 numbers, lengths below 2 m, unit axes, proper rotations, limits in order.
 @retval kUnusableInput naming the link or joint at fault. */
Result<void> CheckHandTree(const HandTree& tree);

}  // namespace graspdb
