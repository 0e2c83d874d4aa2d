#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/geometry/collision_shape.h"
#include "engine/geometry/solid.h"
#include "engine/geometry/sphere_tree.h"
#include "engine/geometry/surface_index.h"
#include "engine/hand/hand_model.h"

namespace graspdb {

/** What collision tests and contact search ask of one link. */
struct LinkShape {
  TriangleMesh mesh_L;  ///< All convex pieces together.
  SphereTree tree;
  SurfaceIndex index;
  CollisionShape shape;
};

/** A hand with its links' search structures. Immutable, shared by threads. */
class HandShape {
 public:
  explicit HandShape(std::shared_ptr<const HandModel> model);

  const HandModel& model() const { return *model_; }
  /** Nothing for a link without geometry. */
  const std::optional<LinkShape>& link(int i) const { return links_[i]; }

  /** The links that joint `k` of an actuator's chain moves and the next one
   does not. */
  const std::vector<int>& chain_links(int actuator, int k) const {
    return chain_links_[actuator][k];
  }

  /** How far, at most, a point of link `link` moves per unit of joint `joint`,
   in any posture: m/rad, or 1 for a slide; 0 when it does not move. */
  double motion_bound(int link, int joint) const {
    return motion_bound_[link][joint];
  }

  /** The most that joint `joint` moves a point of any link, m/rad or 1. */
  double lever(int joint) const { return lever_[joint]; }

  /** How far, at most, a point of the link lies from the hand's origin, m. */
  double reach(int link) const { return reach_[link]; }

 private:
  std::shared_ptr<const HandModel> model_;
  std::vector<std::optional<LinkShape>> links_;
  std::vector<std::vector<std::vector<int>>> chain_links_;
  std::vector<std::vector<double>> motion_bound_;
  std::vector<double> lever_;
  std::vector<double> reach_;
};

/** True when the link, posed in the object's frame, penetrates the solid or
 lies inside it. The distance field decides what it can prove, FCL the rest. */
bool LinkCollides(const LinkShape& link, const RigidTransform& X_OL,
                  const Solid& solid);

/** The first link that collides, or -1.
 @param X_HL  All link poses, from CalcLinkPoses(). */
int FindCollidingLink(const HandShape& hand, const RigidTransform& X_OH,
                      const std::vector<RigidTransform>& X_HL,
                      const Solid& solid);

/** The same as the distance field alone tells it: links that overlap by a few
 tenths of a millimetre may pass. */
int EstimateCollidingLink(const HandShape& hand, const RigidTransform& X_OH,
                          const std::vector<RigidTransform>& X_HL,
                          const Solid& solid);

/** A pair of links that collide with each other, or nothing. */
std::optional<std::pair<int, int>> FindSelfCollision(
    const HandShape& hand, const std::vector<RigidTransform>& X_HL);

/** A proven lower bound, m, of the gap between two links of the hand; within
 the range. */
double CalcLinkGapBound(const HandShape& hand, int link_A, int link_B,
                        const std::vector<RigidTransform>& X_HL,
                        const DistanceRange& range = {});

/** True when two links of the hand penetrate each other. The trees of balls
 decide what they can prove, FCL the rest. */
bool LinksCollide(const HandShape& hand, int link_A, int link_B,
                  const std::vector<RigidTransform>& X_HL);

/** A proven lower bound, m, of the gap between a link and the solid; within the
 range. */
double CalcGapBound(const LinkShape& link, const RigidTransform& X_OL,
                    const Solid& solid, const DistanceRange& range = {});

/** The gap, m, as the interpolated field tells it, to a few tenths of a
 millimetre near contact and to a half farther away; within the range. For
 choosing steps, not for deciding. */
double EstimateGap(const LinkShape& link, const RigidTransform& X_OL,
                   const Solid& solid, const DistanceRange& range = {});

}  // namespace graspdb
