#include "engine/geometry/triangle_mesh.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "engine/base/contract.h"

namespace graspdb {

TriangleMesh::TriangleMesh(std::vector<Eigen::Vector3d> vertices,
                           std::vector<Eigen::Vector3i> triangles)
    : vertices_(std::move(vertices)), triangles_(std::move(triangles)) {
  for (const Eigen::Vector3i& t : triangles_) {
    GRASPDB_EXPECTS(t.minCoeff() >= 0 && t.maxCoeff() < num_vertices());
  }
  normals_.reserve(triangles_.size());
  areas_.reserve(triangles_.size());
  for (int f = 0; f < num_triangles(); ++f) {
    const Eigen::Vector3d twice_area =
        (corner(f, 1) - corner(f, 0)).cross(corner(f, 2) - corner(f, 0));
    const double length = twice_area.norm();
    normals_.push_back(length > 0.0 ? Eigen::Vector3d(twice_area / length)
                                    : Eigen::Vector3d::Zero());
    areas_.push_back(0.5 * length);
    total_area_ += areas_.back();
  }
  if (!vertices_.empty()) {
    box_min_ = box_max_ = vertices_.front();
    for (const Eigen::Vector3d& p : vertices_) {
      box_min_ = box_min_.cwiseMin(p);
      box_max_ = box_max_.cwiseMax(p);
    }
  }
}

MassProperties CalcMassProperties(const TriangleMesh& mesh) {
  MassProperties result;
  result.area = mesh.total_area();
  // Tetrahedra from the box centre to each face: near the mesh, so that a
  // far-away frame origin costs no digits.
  const Eigen::Vector3d apex = 0.5 * (mesh.box_min() + mesh.box_max());
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    const Eigen::Vector3d a = mesh.corner(f, 0) - apex;
    const Eigen::Vector3d b = mesh.corner(f, 1) - apex;
    const Eigen::Vector3d c = mesh.corner(f, 2) - apex;
    const double volume = a.dot(b.cross(c)) / 6.0;
    result.volume += volume;
    moment += volume * (a + b + c) / 4.0;
  }
  result.p_McCM = apex;
  if (result.volume != 0.0) result.p_McCM += moment / result.volume;
  for (const Eigen::Vector3d& p : mesh.vertices()) {
    result.max_radius = std::max(result.max_radius, (p - result.p_McCM).norm());
  }
  if (result.volume == 0.0) return result;
  // ∫ p pᵀ over the tetrahedra between the mass centre and the faces.
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    const Eigen::Vector3d a = mesh.corner(f, 0) - result.p_McCM;
    const Eigen::Vector3d b = mesh.corner(f, 1) - result.p_McCM;
    const Eigen::Vector3d c = mesh.corner(f, 2) - result.p_McCM;
    const Eigen::Vector3d s = a + b + c;
    second += a.dot(b.cross(c)) / 120.0 *
              (s * s.transpose() + a * a.transpose() + b * b.transpose() +
               c * c.transpose());
  }
  second /= result.volume;
  result.gyration = second.trace() * Eigen::Matrix3d::Identity() - second;
  return result;
}

TriangleMesh CalcTransformed(const TriangleMesh& mesh_M,
                             const RigidTransform& X_AM, double scale) {
  GRASPDB_EXPECTS(scale > 0.0);
  std::vector<Eigen::Vector3d> vertices;
  vertices.reserve(mesh_M.vertices().size());
  for (const Eigen::Vector3d& p_M : mesh_M.vertices()) {
    vertices.push_back(scale * (X_AM.rotation * p_M) + X_AM.translation);
  }
  return TriangleMesh(std::move(vertices), mesh_M.triangles());
}

TriangleMesh CalcUnion(const std::vector<TriangleMesh>& meshes) {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  for (const TriangleMesh& mesh : meshes) {
    const int offset = static_cast<int>(vertices.size());
    vertices.insert(vertices.end(), mesh.vertices().begin(),
                    mesh.vertices().end());
    for (const Eigen::Vector3i& t : mesh.triangles()) {
      triangles.push_back(t + Eigen::Vector3i::Constant(offset));
    }
  }
  return TriangleMesh(std::move(vertices), std::move(triangles));
}

bool IsClosed(const TriangleMesh& mesh) {
  // Where the edges lead that leave each vertex, one vertex after the other.
  std::vector<int> ends(3 * mesh.triangles().size());
  std::vector<int> first(static_cast<size_t>(mesh.num_vertices()) + 1, 0);
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    for (const int v : t) ++first[v];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    for (int k = 0; k < 3; ++k) ends[--first[t[k]]] = t[(k + 1) % 3];
  }
  const auto leaving = [&](int v) {
    return std::span(ends).subspan(first[v], first[v + 1] - first[v]);
  };
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    const std::span<int> edges = leaving(v);
    std::sort(edges.begin(), edges.end());
    if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) {
      return false;
    }
  }
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    for (const int end : leaving(v)) {
      const std::span<int> back = leaving(end);
      if (!std::binary_search(back.begin(), back.end(), v)) return false;
    }
  }
  return !ends.empty();
}

}  // namespace graspdb
