#include "engine/admission/mesh_decimation.h"

#include <algorithm>
#include <new>
#include <utility>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Edge_length_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Midpoint_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include "engine/admission/mesh_repair.h"
#include "engine/base/contract.h"

namespace graspdb {
namespace {

namespace sms = CGAL::Surface_mesh_simplification;

using SurfaceMesh = CGAL::Surface_mesh<
    CGAL::Exact_predicates_inexact_constructions_kernel::Point_3>;

// Above this, the shortest edges are merged first, down to half of it: half the
// time of the better way for hardly visible edges.
constexpr int kManyTriangles = 100'000;

SurfaceMesh ToSurfaceMesh(const TriangleMesh& mesh) {
  SurfaceMesh surface;
  std::vector<SurfaceMesh::Vertex_index> index;
  for (const Eigen::Vector3d& p : mesh.vertices()) {
    index.push_back(surface.add_vertex({p.x(), p.y(), p.z()}));
  }
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    surface.add_face(index[t[0]], index[t[1]], index[t[2]]);
  }
  return surface;
}

// @pre Nothing that was removed is left in it.
TriangleMesh ToTriangleMesh(const SurfaceMesh& surface) {
  std::vector<Eigen::Vector3d> vertices;
  for (const auto v : surface.vertices()) {
    const auto& p = surface.point(v);
    vertices.emplace_back(p.x(), p.y(), p.z());
  }
  std::vector<Eigen::Vector3i> triangles;
  for (const auto f : surface.faces()) {
    Eigen::Vector3i triangle;
    int k = 0;
    for (const auto v : vertices_around_face(surface.halfedge(f), surface)) {
      triangle[k++] = static_cast<int>(v.idx());
    }
    triangles.push_back(triangle);
  }
  return TriangleMesh(std::move(vertices), std::move(triangles));
}

// Collapses the cheapest edges until so many triangles are left, without
// turning any face over.
template <typename Cost, typename Placement>
void CollapseEdges(SurfaceMesh& surface, int max_triangles, const Cost& cost,
                   const Placement& placement) {
  const std::size_t edges = static_cast<std::size_t>(max_triangles) / 2 * 3;
  sms::edge_collapse(
      surface, sms::Count_stop_predicate<SurfaceMesh>(edges + 1),
      CGAL::parameters::get_cost(cost).get_placement(
          sms::Bounded_normal_change_placement<Placement>(placement)));
  surface.collect_garbage();
}

}  // namespace

Result<TriangleMesh> Decimate(const TriangleMesh& mesh, int max_triangles) {
  GRASPDB_EXPECTS(max_triangles >= 4);
  if (mesh.num_triangles() <= max_triangles) return mesh;
  GRASPDB_EXPECTS(IsClosed(mesh));
  SurfaceMesh surface = ToSurfaceMesh(mesh);
  try {
    if (mesh.num_triangles() > kManyTriangles) {
      CollapseEdges(surface, std::max(max_triangles, kManyTriangles / 2),
                    sms::Edge_length_cost<SurfaceMesh>(),
                    sms::Midpoint_placement<SurfaceMesh>());
    }
    CollapseEdges(surface, max_triangles,
                  sms::LindstromTurk_cost<SurfaceMesh>(),
                  sms::LindstromTurk_placement<SurfaceMesh>());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return Error{ErrorCode::kInternal, "the mesh could not be simplified"};
  }
  TriangleMesh simplified = ToTriangleMesh(surface);
  if (!IsClosed(simplified)) {
    return Error{ErrorCode::kInternal, "the simplified mesh is not closed"};
  }
  // Faces may cross where it is thin.
  Result<RepairedMesh> repaired = RepairMesh(simplified);
  const bool better =
      repaired && repaired->mesh.num_triangles() <= max_triangles;
  return better ? std::move(repaired->mesh) : simplified;
}

}  // namespace graspdb
