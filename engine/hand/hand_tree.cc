#include "engine/hand/hand_tree.h"

#include <cmath>
#include <set>
#include <utility>

namespace graspdb {
namespace {

constexpr size_t kMostLinks = 64;
constexpr size_t kMostPieces = 64;
constexpr size_t kLongestName = 200;
constexpr double kLongest = 2.0;  // m
constexpr double kTolerance = 1e-6;
// Of a joint that mimics another, to that one's motion.
constexpr double kLeastRatio = 0.01;
constexpr double kMostRatio = 100.0;

bool IsShort(const Eigen::Vector3d& p) {
  return p.allFinite() && p.norm() < kLongest;
}

bool IsPose(const RigidTransform& X) {
  return IsShort(X.translation) && X.rotation.allFinite() &&
         (X.rotation.transpose() * X.rotation).isIdentity(kTolerance) &&
         X.rotation.determinant() > 0.0;
}

bool IsName(const std::string& name) {
  return !name.empty() && name.size() <= kLongestName;
}

Result<void> CheckJoint(const HandTree::Joint& joint) {
  if (!IsName(joint.name))
    return MakeHandError("a joint has no name, or a long one");
  const std::string its = "joint " + joint.name;
  if (!IsPose(joint.X_PJ)) return MakeHandError(its + " is nowhere in reach");
  if (!(std::abs(joint.axis_J.norm() - 1.0) < kTolerance)) {
    return MakeHandError(its + " has no axis");
  }
  // A full turn either way, or as far as any hand slides.
  const double most =
      joint.type == JointType::kPrismatic ? kLongest : 2.0 * M_PI;
  if (!(-most <= joint.lower && joint.lower < joint.upper &&
        joint.upper <= most)) {
    return MakeHandError(its + " has no range of motion that a hand has");
  }
  if (joint.mimicked.size() > kLongestName ||
      !(std::abs(joint.ratio) >= kLeastRatio &&
        std::abs(joint.ratio) < kMostRatio)) {
    return MakeHandError(its + " mimics another in no way that a hand does");
  }
  return {};
}

}  // namespace

Error MakeHandError(const std::string& what, std::string hint,
                    std::string field) {
  return Error{ErrorCode::kUnusableInput, "hand description: " + what,
               std::move(hint), std::move(field)};
}

Result<void> CheckHandTree(const HandTree& tree) {
  if (tree.links.empty() || tree.links.size() > kMostLinks) {
    return MakeHandError("it must have 1 to 64 links");
  }
  std::set<std::string> links;
  std::set<std::string> joints;
  size_t pieces = 0;
  for (int i = 0; i < static_cast<int>(tree.links.size()); ++i) {
    const HandTree::Link& link = tree.links[static_cast<size_t>(i)];
    if (!IsName(link.name))
      return MakeHandError("a link has no name, or a long one");
    const std::string its = "link " + link.name;
    if (!links.insert(link.name).second)
      return MakeHandError(its + " is there twice");
    if (i == 0 ? link.parent != -1 : link.parent < 0 || link.parent >= i) {
      return MakeHandError(its + " comes before its parent");
    }
    if (i > 0) {
      GRASPDB_TRY_VOID(CheckJoint(link.joint));
      if (!joints.insert(link.joint.name).second) {
        return MakeHandError("joint " + link.joint.name + " is there twice");
      }
    }
    if (!(link.mass >= 0.0 && link.mass < 100.0) || !IsShort(link.p_LcCM)) {
      return MakeHandError(its + " has no mass that a hand's has");
    }
    for (const HandTree::Piece& piece : link.pieces) {
      if (!IsName(piece.mesh))
        return MakeHandError(its + " has a mesh without a name");
      if (!IsPose(piece.X_LM))
        return MakeHandError(its + " has a mesh out of reach");
    }
    pieces += link.pieces.size();
  }
  if (pieces == 0 || pieces > kMostPieces) {
    return MakeHandError("its links must have 1 to 64 collision meshes");
  }
  return {};
}

}  // namespace graspdb
