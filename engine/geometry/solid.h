#pragma once

#include <cstdint>
#include <memory>

#include "engine/geometry/collision_shape.h"
#include "engine/geometry/distance_field.h"
#include "engine/geometry/seen_surface.h"
#include "engine/geometry/surface_index.h"
#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** An object to be grasped, or a part of one, with everything that grasping
 asks of it, built once. Immutable, shared by threads. */
class Solid {
 public:
  /** @param mesh_O  A closed mesh in the object's frame.
   @param num_surface_faces  The first so many faces may be touched; the rest
     are caps, where a part was cut off. All by default.
   @param seen  What a point cloud shows of it; null: all is known. */
  explicit Solid(TriangleMesh mesh_O, int num_surface_faces = -1,
                 std::shared_ptr<const SeenSurface> seen = nullptr);

  const TriangleMesh& mesh_O() const { return mesh_O_; }
  const SurfaceIndex& index() const { return index_; }
  const DistanceField& field() const { return field_; }
  const CollisionShape& shape() const { return shape_; }
  const MassProperties& mass() const { return mass_; }
  bool is_cap(int face) const { return face >= num_surface_faces_; }
  /** About what it takes, for whoever keeps many. */
  int64_t CalcBytes() const;
  bool is_seen(const Eigen::Vector3d& p_O) const {
    return seen_ == nullptr || seen_->Shows(p_O);
  }

 private:
  TriangleMesh mesh_O_;
  int num_surface_faces_;
  std::shared_ptr<const SeenSurface> seen_;
  MassProperties mass_;
  SurfaceIndex index_;
  DistanceField field_;
  CollisionShape shape_;
};

}  // namespace graspdb
