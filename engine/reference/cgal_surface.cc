#include "engine/reference/cgal_surface.h"

#include <cmath>

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/mesh_segmentation.h>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Tree = CGAL::AABB_tree<
    CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Mesh>>>;

}  // namespace

struct CgalSurface::Impl {
  Mesh mesh;
  Tree tree;
};

CgalSurface::CgalSurface(const TriangleMesh& mesh_M)
    : impl_(std::make_unique<Impl>()) {
  Mesh& mesh = impl_->mesh;
  for (const Eigen::Vector3d& p : mesh_M.vertices()) {
    mesh.add_vertex({p.x(), p.y(), p.z()});
  }
  using Index = Mesh::Vertex_index;
  for (const Eigen::Vector3i& t : mesh_M.triangles()) {
    const auto face = mesh.add_face(Index(static_cast<unsigned>(t[0])),
                                    Index(static_cast<unsigned>(t[1])),
                                    Index(static_cast<unsigned>(t[2])));
    GRASPDB_EXPECTS(face != Mesh::null_face());
  }
  impl_->tree.rebuild(faces(mesh).begin(), faces(mesh).end(), mesh);
  impl_->tree.accelerate_distance_queries();
}

CgalSurface::~CgalSurface() = default;
CgalSurface::CgalSurface(CgalSurface&&) noexcept = default;

double CgalSurface::CalcDistance(const Eigen::Vector3d& p_M) const {
  return std::sqrt(impl_->tree.squared_distance({p_M.x(), p_M.y(), p_M.z()}));
}

std::vector<double> CgalSurface::CalcShapeDiameters() const {
  std::vector<double> diameters(impl_->mesh.num_faces());
  Mesh mesh = impl_->mesh;
  auto [map, created] =
      mesh.add_property_map<Mesh::Face_index, double>("f:diameter", 0.0);
  CGAL::sdf_values(mesh, map, 2.0 / 3.0 * CGAL_PI, 25, false);
  for (const auto face : faces(mesh)) diameters[face.idx()] = map[face];
  return diameters;
}

}  // namespace graspdb
