#pragma once

#include <memory>
#include <vector>

#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** A surface as CGAL has it: what our own closest points and shape diameters
 are measured beside. */
class CgalSurface {
 public:
  /** @pre The mesh is a closed manifold. */
  explicit CgalSurface(const TriangleMesh& mesh_M);
  ~CgalSurface();
  CgalSurface(CgalSurface&&) noexcept;

  /** How far p is from the surface, m, by CGAL's AABB tree. */
  double CalcDistance(const Eigen::Vector3d& p_M) const;

  /** Per face the shape diameter, m, by CGAL::sdf_values() without smoothing.
   */
  std::vector<double> CalcShapeDiameters() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspdb
