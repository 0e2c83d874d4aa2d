#include "engine/hand/hand_shape.h"

#include <algorithm>
#include <utility>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// Between the probes of a link, metres: it bulges by a tenth of a millimetre
// there at most.
constexpr double kProbeSpacing = 0.002;
// Where only the sign of a distance matters.
constexpr DistanceRange kSign{0.0, 1e-9};

// The joints of `link` and its ancestors, the nearest first.
std::vector<int> ListJointsTowardsBase(const HandModel& hand, int link) {
  std::vector<int> joints;
  for (int i = link; i > 0; i = hand.links()[i].parent) {
    joints.push_back(hand.links()[i].joint);
  }
  return joints;
}

}  // namespace

HandShape::HandShape(std::shared_ptr<const HandModel> model)
    : model_(std::move(model)) {
  const HandModel& hand = *model_;
  links_.resize(hand.num_links());
  reach_.assign(hand.num_links(), 0.0);
  lever_.assign(hand.num_joints(), 0.0);
  motion_bound_.assign(hand.num_links(),
                       std::vector<double>(hand.num_joints(), 0.0));
  for (int i = 0; i < hand.num_links(); ++i) {
    TriangleMesh mesh = CalcUnion(hand.links()[i].pieces_L);
    if (mesh.num_triangles() == 0) continue;
    SphereTree tree(mesh, kProbeSpacing);
    SurfaceIndex index(mesh);
    CollisionShape shape(mesh);
    // Radius about the nearest joint's origin, then about its ancestors': each
    // joint origin is a fixed distance (plus slide travel) from the next.
    double radius = tree.center().norm() + tree.radius();
    for (const int j : ListJointsTowardsBase(hand, i)) {
      const HandJoint& joint = hand.joints()[j];
      if (joint.type == JointType::kPrismatic) {
        motion_bound_[i][j] = 1.0;
        radius += std::max(std::abs(joint.lower), std::abs(joint.upper));
      } else {
        motion_bound_[i][j] = radius;
      }
      lever_[j] = std::max(lever_[j], motion_bound_[i][j]);
      radius += joint.X_PJ.translation.norm();
    }
    reach_[i] = radius;
    links_[i].emplace(LinkShape{std::move(mesh), std::move(tree),
                                std::move(index), std::move(shape)});
  }
  for (const HandActuator& actuator : hand.actuators()) {
    std::vector<std::vector<int>>& groups = chain_links_.emplace_back();
    groups.resize(actuator.joints.size());
    for (int i = 1; i < hand.num_links(); ++i) {
      // The chain's joint that is nearest to the link owns it.
      for (const int j : ListJointsTowardsBase(hand, i)) {
        const auto found =
            std::find(actuator.joints.begin(), actuator.joints.end(), j);
        if (found == actuator.joints.end()) continue;
        groups[found - actuator.joints.begin()].push_back(i);
        break;
      }
    }
  }
}

double CalcGapBound(const LinkShape& link, const RigidTransform& X_OL,
                    const Solid& solid, const DistanceRange& range) {
  const double error = solid.field().max_error();
  return link.tree.CalcLowerBound(PosedField(solid.field(), X_OL),
                                  {range.enough + error, range.most + error}) -
         error;
}

double EstimateGap(const LinkShape& link, const RigidTransform& X_OL,
                   const Solid& solid, const DistanceRange& range) {
  return link.tree.EstimateMinimum(PosedField(solid.field(), X_OL), range);
}

bool LinkCollides(const LinkShape& link, const RigidTransform& X_OL,
                  const Solid& solid) {
  if (CalcGapBound(link, X_OL, solid, kSign) > 0.0) return false;
  // A probe that is certainly inside: FCL need not be asked.
  const double error = solid.field().max_error();
  if (EstimateGap(link, X_OL, solid, {-error, 0.0}) < -error) return true;
  if (solid.shape().Intersects(link.shape, X_OL)) return true;
  // No surfaces cross: either free, or wholly inside.
  const Eigen::Vector3d p_O = X_OL * link.tree.probes()[0];
  return solid.field().Calc(p_O) < solid.field().max_error() &&
         solid.index().CalcSignedDistance(p_O) < 0.0;
}

int FindCollidingLink(const HandShape& hand, const RigidTransform& X_OH,
                      const std::vector<RigidTransform>& X_HL,
                      const Solid& solid) {
  for (int i = 0; i < hand.model().num_links(); ++i) {
    if (hand.link(i) && LinkCollides(*hand.link(i), X_OH * X_HL[i], solid)) {
      return i;
    }
  }
  return -1;
}

int EstimateCollidingLink(const HandShape& hand, const RigidTransform& X_OH,
                          const std::vector<RigidTransform>& X_HL,
                          const Solid& solid) {
  for (int i = 0; i < hand.model().num_links(); ++i) {
    if (hand.link(i) &&
        EstimateGap(*hand.link(i), X_OH * X_HL[i], solid, kSign) < 0.0) {
      return i;
    }
  }
  return -1;
}

double CalcLinkGapBound(const HandShape& hand, int link_A, int link_B,
                        const std::vector<RigidTransform>& X_HL,
                        const DistanceRange& range) {
  return hand.link(link_A)->tree.CalcGapBound(
      hand.link(link_B)->tree, X_HL[link_A].Inverse() * X_HL[link_B], range);
}

bool LinksCollide(const HandShape& hand, int link_A, int link_B,
                  const std::vector<RigidTransform>& X_HL) {
  const LinkShape& A = *hand.link(link_A);
  const LinkShape& B = *hand.link(link_B);
  const RigidTransform X_AB = X_HL[link_A].Inverse() * X_HL[link_B];
  return A.tree.CalcGapBound(B.tree, X_AB, kSign) <= 0.0 &&
         A.shape.Intersects(B.shape, X_AB);
}

std::optional<std::pair<int, int>> FindSelfCollision(
    const HandShape& hand, const std::vector<RigidTransform>& X_HL) {
  for (const auto& [a, b] : hand.model().self_collision_pairs()) {
    if (hand.link(a) && hand.link(b) && LinksCollide(hand, a, b, X_HL)) {
      return std::pair(a, b);
    }
  }
  return std::nullopt;
}

}  // namespace graspdb
