#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/result.h"
#include "engine/hand/hand_model.h"
#include "engine/hand/hand_tree.h"

namespace graspdb {

/** What a grasp planner needs to know of a hand and a URDF does not say. Links
 and joints are named as in the URDF. */
struct HandAnnotations {
  struct Actuator {
    std::string name;
    std::string joint;  ///< The joint that it drives; others mimic that one.
    bool closes{false};
  };
  struct Breakaway {
    std::string joint;           ///< When this one is blocked …
    std::string released_joint;  ///< … this one goes on …
    double ratio{1.0};  ///< … at this multiple of the motor's travel.
  };
  struct ContactPoint {
    std::string link;
    Eigen::Vector3d p_L;
    Eigen::Vector3d nhat_L;
  };
  std::string name;
  std::vector<Actuator> actuators;
  std::vector<Breakaway> breakaway;
  std::vector<ContactPoint> contact_points;
  std::vector<std::pair<std::string, std::string>> ignored_collisions;
  Eigen::Vector3d approach_H{Eigen::Vector3d::UnitZ()};
  double closing_force{15.0};
};

/** So many faces draw any convex piece finely. */
inline constexpr int kMostPieceTriangles = 5000;

/** Returns the mesh that a URDF names, in metres. */
using MeshLoader = std::function<Result<TriangleMesh>(const std::string&)>;

/** Builds a hand from what its URDF and annotations say. The first link's frame
 becomes H. Every collision mesh is one convex piece of its link, of at most
 kMostPieceTriangles, dented by 0.1 mm at most.
 @pre CheckHandTree() has passed the tree.
 @retval kUnusableInput naming the link, joint or mesh at fault. */
Result<HandModel> MakeHand(const HandTree& tree,
                           const HandAnnotations& annotations,
                           const MeshLoader& load_mesh);

}  // namespace graspdb
