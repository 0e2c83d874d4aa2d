#pragma once

#include <memory>

#include "engine/geometry/triangle_mesh.h"
#include "engine/math/rigid_transform.h"

namespace graspdb {

/** A surface in FCL's bounding-volume tree: the judge of whether two surfaces
 intersect. Immutable, shared by threads. */
class CollisionShape {
 public:
  /** @pre The mesh has a face. */
  explicit CollisionShape(const TriangleMesh& mesh_A);
  ~CollisionShape();
  CollisionShape(CollisionShape&&) noexcept;
  CollisionShape& operator=(CollisionShape&&) noexcept;

  /** True when a triangle of this surface A meets one of the other, B. A solid
   wholly inside the other one is not seen. */
  bool Intersects(const CollisionShape& other,
                  const RigidTransform& X_AB) const;

  /** The same by FCL's own search, which takes three times as long: what
   Intersects() is tested and measured against. */
  bool IntersectsByFcl(const CollisionShape& other,
                       const RigidTransform& X_AB) const;

  /** The least distance, m, between a triangle of this surface A and one of the
   other, B; 0 where they meet. Takes tenths of milliseconds. */
  double CalcDistance(const CollisionShape& other,
                      const RigidTransform& X_AB) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspdb
