#pragma once

#include <limits>
#include <memory>
#include <optional>

#include <Eigen/Core>

#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** The point of a surface that is closest to a query point. */
struct ClosestPoint {
  double distance{0.0};  ///< Unsigned, m.
  Eigen::Vector3d p_M{Eigen::Vector3d::Zero()};
  int face{-1};
  /** The angle-weighted pseudonormal of the face, edge or vertex that the point
   lies on (Baerentzen and Aanaes 2005); unit length, out of the solid. */
  Eigen::Vector3d pseudonormal{Eigen::Vector3d::UnitZ()};
  /** False when it lies on an edge or a vertex, unless all is flat there. */
  bool on_face{true};
};

/** Closest points and inside tests on a mesh, through Embree's tree; exact in
 double precision. Immutable, shared by threads. */
class SurfaceIndex {
 public:
  explicit SurfaceIndex(const TriangleMesh& mesh_M);
  ~SurfaceIndex();
  SurfaceIndex(SurfaceIndex&&) noexcept;
  SurfaceIndex& operator=(SurfaceIndex&&) noexcept;

  /** The closest surface point no farther than max_distance; nothing when there
   is none. Ties go to the first face. */
  std::optional<ClosestPoint> FindClosest(
      const Eigen::Vector3d& p_M,
      double max_distance = std::numeric_limits<double>::infinity()) const;

  /** Distance to the surface, negative inside. @pre The mesh is closed and
   has a face. */
  double CalcSignedDistance(const Eigen::Vector3d& p_M) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspdb
