#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/math/rigid_transform.h"

namespace graspdb {

/** An immutable triangle mesh with value semantics. Vertices are metres in the
 mesh's own frame M; triangles index them counter-clockwise seen from outside,
 so face normals point out of the solid. */
class TriangleMesh {
 public:
  TriangleMesh() = default;
  /** @pre Every index lies in [0, vertices.size()). */
  TriangleMesh(std::vector<Eigen::Vector3d> vertices,
               std::vector<Eigen::Vector3i> triangles);

  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }
  const std::vector<Eigen::Vector3i>& triangles() const { return triangles_; }
  int num_vertices() const { return static_cast<int>(vertices_.size()); }
  int num_triangles() const { return static_cast<int>(triangles_.size()); }

  /** Corner k (0..2) of triangle f. */
  const Eigen::Vector3d& corner(int f, int k) const {
    return vertices_[triangles_[f][k]];
  }
  /** The unit outward normal of triangle f; zero for a degenerate one. */
  const Eigen::Vector3d& normal(int f) const { return normals_[f]; }
  /** The area of triangle f, m². */
  double area(int f) const { return areas_[f]; }
  /** The sum of all areas, m². */
  double total_area() const { return total_area_; }
  Eigen::Vector3d centroid(int f) const {
    return (corner(f, 0) + corner(f, 1) + corner(f, 2)) / 3.0;
  }

  /** The axis-aligned box, metres; both zero for an empty mesh. */
  const Eigen::Vector3d& box_min() const { return box_min_; }
  const Eigen::Vector3d& box_max() const { return box_max_; }
  /** The length of the box's diagonal, metres. */
  double diagonal() const { return (box_max_ - box_min_).norm(); }

  bool operator==(const TriangleMesh& other) const {
    return vertices_ == other.vertices_ && triangles_ == other.triangles_;
  }

 private:
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Eigen::Vector3i> triangles_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<double> areas_;
  double total_area_{0.0};
  Eigen::Vector3d box_min_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d box_max_{Eigen::Vector3d::Zero()};
};

/** Volume, area and mass centre of a closed mesh of uniform density. */
struct MassProperties {
  double volume{0.0};  ///< m³; negative when the mesh is inside out.
  double area{0.0};    ///< m².
  Eigen::Vector3d p_McCM{Eigen::Vector3d::Zero()};  ///< Mass centre in M, m.
  double max_radius{0.0};  ///< Farthest vertex from the mass centre, m.
  /** Inertia about the mass centre over mass, in M's axes, m². */
  Eigen::Matrix3d gyration{Eigen::Matrix3d::Zero()};
};

/** By the divergence theorem over the faces. @pre The mesh is closed. */
MassProperties CalcMassProperties(const TriangleMesh& mesh);

/** The mesh re-expressed: p_A = scale · R_AM p_M + p_AM. @pre scale > 0. */
TriangleMesh CalcTransformed(const TriangleMesh& mesh_M,
                             const RigidTransform& X_AM, double scale = 1.0);

/** All meshes in one, in the given order. */
TriangleMesh CalcUnion(const std::vector<TriangleMesh>& meshes);

/** True when each edge is shared by exactly two faces that run through it in
 opposite directions. */
bool IsClosed(const TriangleMesh& mesh);

}  // namespace graspdb
