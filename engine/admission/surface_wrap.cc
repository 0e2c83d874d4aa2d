#include "engine/admission/surface_wrap.h"

#include <optional>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/compute_normal.h>
#include <CGAL/Polygon_mesh_processing/polygon_mesh_to_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#include <fmt/core.h>

namespace graspdb {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using SurfaceMesh = CGAL::Surface_mesh<Point>;

// Lengths as shares of the diagonal of the soup's box.
constexpr double kAlpha = 1.0 / 75.0;
constexpr double kOffset = 1.0 / 1000.0;
constexpr double kCoarsening = 3.0;  // Of a wrap of too many points.
// The share of the offset that is taken back after wrapping.
constexpr double kShrinking = 0.8;

struct TooManyPoints {};

/** Ends a wrap that takes too many points. The library calls it at each step;
 its own visitor does nothing. */
struct PointCounter : CGAL::Alpha_wraps_3::internal::Wrapping_default_visitor {
  template <class Wrapper, class Vertex>
  void after_Steiner_point_insertion(const Wrapper&, Vertex) {
    if (++points > most) throw TooManyPoints();
  }
  std::size_t most{0};
  std::size_t points{0};
};

std::optional<SurfaceMesh> TryWrap(const std::vector<Point>& points,
                                   const std::vector<TriangleSoup::Face>& faces,
                                   double alpha, double offset,
                                   std::size_t most_points) {
  SurfaceMesh wrap;
  PointCounter counter;
  counter.most = most_points;
  try {
    CGAL::alpha_wrap_3(points, faces, alpha, offset, wrap,
                       CGAL::parameters::default_values(),
                       CGAL::parameters::visitor(counter));
  } catch (const TooManyPoints&) {
    return std::nullopt;
  }
  return wrap;
}

// The wrap moved inwards by a distance, so that it lies where the mesh is; the
// wrap itself where that would make it cross itself.
SurfaceMesh Shrink(const SurfaceMesh& wrap, double distance) {
  SurfaceMesh shrunk = wrap;
  for (const auto v : wrap.vertices()) {
    const Kernel::Vector_3 normal = pmp::compute_vertex_normal(v, wrap);
    shrunk.point(v) = wrap.point(v) - distance * normal;
  }
  return pmp::does_self_intersect(shrunk) ? wrap : shrunk;
}

TriangleSoup ToSoup(const SurfaceMesh& surface) {
  std::vector<Point> points;
  TriangleSoup soup;
  pmp::polygon_mesh_to_polygon_soup(surface, points, soup.faces);
  for (const Point& p : points) soup.points.emplace_back(p.x(), p.y(), p.z());
  return soup;
}

}  // namespace

TriangleSoup WrapSurface(const TriangleSoup& soup, double diagonal,
                         std::size_t most_points, RepairLog& log) {
  std::vector<Point> points;
  for (const Eigen::Vector3d& p : soup.points) {
    points.emplace_back(p.x(), p.y(), p.z());
  }
  for (double coarseness = 1.0;; coarseness *= kCoarsening) {
    const double alpha = coarseness * kAlpha * diagonal;
    const double offset = coarseness * kOffset * diagonal;
    const auto wrap = TryWrap(points, soup.faces, alpha, offset, most_points);
    if (!wrap) continue;
    log.Add(fmt::format("wrapped {}, closing gaps of up to {:.2g} mm",
                        DescribeCount(soup.faces.size(), "face", "faces"),
                        1e3 * alpha));
    return ToSoup(Shrink(*wrap, kShrinking * offset));
  }
}

}  // namespace graspdb
