#include "engine/admission/surface_reconstruction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#include <fmt/core.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "engine/geometry/subdivision.h"
#include "engine/math/kd_tree.h"

namespace graspdb {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Points = std::vector<Eigen::Vector3d>;

constexpr int kMostPoints = 20'000;
// A point this many times farther from its neighbours than is usual is none of
// the object's, nor are clusters with less than this share of all points.
constexpr double kOutlierDistance = 3.0;
constexpr double kClusterGap = 5.0;  // Spacings.
constexpr double kSmallestCluster = 0.05;
constexpr int kNeighbours = 8;
constexpr int kPlaneNeighbours = 12;
// Spacings. The largest hole that random sampling leaves among a few thousand
// points has a radius of √(ln n / π) or about 1.6 of them.
constexpr double kAlpha = 1.5;  // And twice the noise.
constexpr double kOffset = 0.5;
constexpr int kViews = 64;
constexpr double kLeastHiddenShare = 0.14;
constexpr double kThinShare = 0.3;
constexpr double kOneSidedAlpha = 0.35;  // Of the diagonal, at least.
constexpr double kHollowGap = 0.3;       // Offsets.
constexpr double kGrowth = 1.5;          // Of alpha while the wrap is hollow.
constexpr double kFlatness = 1e-3;       // Of the diagonal, rms.
constexpr int kSmoothings = 8;
constexpr double kLeastHalf = 0.001;  // Of a wall's thickness, m.

Error MakeError(std::string message) {
  return Error{ErrorCode::kUnusableInput, std::move(message),
               "Send more points of the object, from all sides.", "mesh"};
}

double CalcMedian(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Each position once, where it comes first.
Points DropCopies(const Points& points) {
  std::set<std::array<double, 3>> seen;
  Points kept;
  for (const Eigen::Vector3d& p : points) {
    if (seen.insert({p.x(), p.y(), p.z()}).second) kept.push_back(p);
  }
  return kept;
}

// The mean distance from each point to its nearest neighbours.
std::vector<double> CalcNeighbourDistances(const Points& points) {
  const KdTree tree(points);
  std::vector<double> distances;
  for (const Eigen::Vector3d& p : points) {
    double sum = 0.0;
    for (const auto& n : tree.FindNearest(p, kNeighbours + 1)) {
      sum += std::sqrt(n.squared_distance) / kNeighbours;
    }
    distances.push_back(sum);
  }
  return distances;
}

// One over the square root of the density: of n random points per area the k-th
// neighbour is r away with k = π n r².
double CalcSpacing(const Points& points) {
  const KdTree tree(points);
  std::vector<double> radii;
  for (const Eigen::Vector3d& p : points) {
    radii.push_back(std::sqrt(
        tree.FindNearest(p, kNeighbours + 1).back().squared_distance));
  }
  return CalcMedian(std::move(radii)) *
         std::sqrt(std::numbers::pi / kNeighbours);
}

// The rms distance of neighbours from their best plane.
double CalcNoise(const Points& points) {
  const KdTree tree(points);
  std::vector<double> residuals;
  for (const Eigen::Vector3d& p : points) {
    Eigen::Matrix3Xd around(3, kPlaneNeighbours);
    const auto neighbours = tree.FindNearest(p, kPlaneNeighbours);
    for (int i = 0; i < kPlaneNeighbours; ++i) {
      around.col(i) = points[neighbours[i].index];
    }
    around.colwise() -= around.rowwise().mean().eval();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
        around * around.transpose() / (kPlaneNeighbours - 3),
        Eigen::EigenvaluesOnly);
    residuals.push_back(std::sqrt(std::max(0.0, solver.eigenvalues()[0])));
  }
  return CalcMedian(std::move(residuals));
}

// The points' rms distance from their best plane.
double CalcThickness(const Points& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    mean += p / static_cast<double>(points.size());
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    spread += (p - mean) * (p - mean).transpose() /
              static_cast<double>(points.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
      spread, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
}

// The points of clusters that hold enough of all.
Points KeepLargeClusters(const Points& points, double gap) {
  const KdTree tree(points);
  std::vector<int> cluster(points.size(), -1);
  std::vector<int> sizes;
  for (std::size_t seed = 0; seed < points.size(); ++seed) {
    if (cluster[seed] >= 0) continue;
    const int id = static_cast<int>(sizes.size());
    sizes.push_back(0);
    std::vector<std::size_t> open{seed};
    cluster[seed] = id;
    while (!open.empty()) {
      const std::size_t i = open.back();
      open.pop_back();
      ++sizes[id];
      for (const auto& n : tree.FindWithin(points[i], gap)) {
        if (cluster[n.index] >= 0) continue;
        cluster[n.index] = id;
        open.push_back(static_cast<std::size_t>(n.index));
      }
    }
  }
  Points kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (sizes[cluster[i]] >=
        kSmallestCluster * static_cast<double>(points.size())) {
      kept.push_back(points[i]);
    }
  }
  return kept;
}

Points DropOutliers(const Points& points) {
  const std::vector<double> distances = CalcNeighbourDistances(points);
  const double most = kOutlierDistance * CalcMedian(distances);
  Points kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (distances[i] <= most) kept.push_back(points[i]);
  }
  return KeepLargeClusters(kept, kClusterGap * CalcSpacing(kept));
}

// One point, the mean, per cell of a grid that is as coarse as need be.
Points ThinOut(const Points& points) {
  if (std::ssize(points) <= kMostPoints) return points;
  const double spacing = CalcSpacing(points);
  for (double cell = spacing;; cell *= 1.2) {
    std::map<std::array<int64_t, 3>, std::pair<Eigen::Vector3d, int>> cells;
    for (const Eigen::Vector3d& p : points) {
      std::array<int64_t, 3> key{};
      for (int k = 0; k < 3; ++k) {
        key[k] = static_cast<int64_t>(std::floor(p[k] / cell));
      }
      auto& [sum, count] =
          cells.try_emplace(key, Eigen::Vector3d::Zero(), 0).first->second;
      sum += p;
      ++count;
    }
    if (std::ssize(cells) > kMostPoints) continue;
    Points thinned;
    for (const auto& [key, value] : cells) {
      thinned.push_back(value.first / value.second);
    }
    return thinned;
  }
}

TriangleMesh Wrap(const Points& points, double alpha, double offset) {
  std::vector<Kernel::Point_3> input;
  for (const Eigen::Vector3d& p : points) {
    input.emplace_back(p.x(), p.y(), p.z());
  }
  SurfaceMesh wrap;
  CGAL::alpha_wrap_3(input, alpha, offset, wrap);
  std::vector<Eigen::Vector3d> vertices;
  std::vector<int> index(wrap.num_vertices() +
                         wrap.number_of_removed_vertices());
  for (const auto v : wrap.vertices()) {
    index[v] = static_cast<int>(vertices.size());
    const Kernel::Point_3& p = wrap.point(v);
    vertices.emplace_back(p.x(), p.y(), p.z());
  }
  std::vector<Eigen::Vector3i> triangles;
  for (const auto f : wrap.faces()) {
    Eigen::Vector3i triangle;
    int k = 0;
    for (const auto v : vertices_around_face(wrap.halfedge(f), wrap)) {
      triangle[k++] = index[v];
    }
    triangles.push_back(triangle);
  }
  return TriangleMesh(std::move(vertices), std::move(triangles));
}

std::vector<Eigen::Vector3d> CalcVertexNormals(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> normals(mesh.num_vertices(),
                                       Eigen::Vector3d::Zero());
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    for (const int v : mesh.triangles()[f]) {
      normals[v] += mesh.area(f) * mesh.normal(f);
    }
  }
  for (Eigen::Vector3d& normal : normals) normal.normalize();
  return normals;
}

// The least share of points, over directions to look from, that stand behind
// others: a cloud from one viewpoint has few, one from all sides about half.
double CalcHiddenShare(const Points& points, double spacing, double noise) {
  const double cell = 1.5 * spacing;
  const double depth = 2.0 * cell + 3.0 * noise;
  double least = 1.0;
  for (int i = 0; i < kViews; ++i) {
    // A spiral over the sphere, evenly spaced.
    const double z = 1.0 - (2.0 * i + 1.0) / kViews;
    const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double r = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d view(r * std::cos(angle), r * std::sin(angle), z);
    const Eigen::Matrix3d R =
        Eigen::Quaterniond::FromTwoVectors(view, Eigen::Vector3d::UnitZ())
            .toRotationMatrix();
    std::map<std::pair<int, int>, double> front;
    const auto cell_of = [cell](const Eigen::Vector3d& p) {
      return std::pair(static_cast<int>(std::floor(p.x() / cell)),
                       static_cast<int>(std::floor(p.y() / cell)));
    };
    for (const Eigen::Vector3d& p : points) {
      const Eigen::Vector3d q = R * p;
      const auto [it, fresh] = front.try_emplace(cell_of(q), q.z());
      if (!fresh) it->second = std::max(it->second, q.z());
    }
    int hidden = 0;
    for (const Eigen::Vector3d& p : points) {
      const Eigen::Vector3d q = R * p;
      hidden += q.z() < front.at(cell_of(q)) - depth;
    }
    least = std::min(least, hidden / static_cast<double>(points.size()));
  }
  return least;
}

// How much of the wrap is as thin as the wrap makes a sheet, and how far the
// points that its two faces go by are apart there: nothing where there is no
// second layer of points.
struct Thinness {
  double share{0.0};
  double gap{0.0};
};

Thinness CalcThinness(const TriangleMesh& wrap, const Points& points,
                      double offset, double noise) {
  const KdTree cloud(points);
  const KdTree vertices(wrap.vertices());
  const auto normals = CalcVertexNormals(wrap);
  const double thickness = 2.0 * (offset + noise);
  Thinness result;
  int count = 0;
  for (int v = 0; v < wrap.num_vertices(); ++v) {
    const Eigen::Vector3d& p = wrap.vertices()[v];
    const Eigen::Vector3d& n = normals[v];
    const auto opposite = vertices.FindNearest(p - thickness * n);
    if (opposite.squared_distance > std::pow(0.75 * thickness, 2) ||
        n.dot(normals[opposite.index]) > -0.5) {
      continue;
    }
    const Eigen::Vector3d& q = wrap.vertices()[opposite.index];
    result.gap += n.dot(points[cloud.FindNearest(p).index] -
                        points[cloud.FindNearest(q).index]);
    ++count;
  }
  if (count > 0) result.gap /= count;
  result.share = static_cast<double>(count) / wrap.num_vertices();
  return result;
}

// Until no edge is longer than that.
TriangleMesh SubdivideTo(TriangleMesh mesh, double longest) {
  const auto has_long_edge = [&] {
    for (int f = 0; f < mesh.num_triangles(); ++f) {
      for (int k = 0; k < 3; ++k) {
        if ((mesh.corner(f, k) - mesh.corner(f, (k + 1) % 3)).norm() >
            longest) {
          return true;
        }
      }
    }
    return false;
  };
  while (has_long_edge() && mesh.num_triangles() < kMostPoints) {
    mesh = Subdivide(mesh);
  }
  return mesh;
}

// Moves vertices along their normals to where the points are: of those in a
// cylinder about the normal, the height that three quarters stay below, less
// what the noise adds to it. So the far face of a thin wall does not count.
// What is thinner than the wrap keeps some thickness.
TriangleMesh DrawBack(const TriangleMesh& wrap, const Points& points,
                      double spacing, double offset, double noise) {
  const KdTree cloud(points);
  const auto normals = CalcVertexNormals(wrap);
  const double radius = 1.2 * spacing;
  const double reach = offset + 3.0 * noise;
  std::vector<std::optional<double>> heights(wrap.num_vertices());
  for (int v = 0; v < wrap.num_vertices(); ++v) {
    std::vector<double> near;
    for (const auto& n : cloud.FindWithin(wrap.vertices()[v], radius + reach)) {
      const Eigen::Vector3d d = points[n.index] - wrap.vertices()[v];
      const double height = d.dot(normals[v]);
      const double aside = (d - height * normals[v]).norm();
      if (aside <= radius && std::abs(height) <= reach) near.push_back(height);
    }
    if (near.size() < 3) continue;
    const auto at = near.begin() + std::ssize(near) * 3 / 4;
    std::nth_element(near.begin(), at, near.end());
    heights[v] = *at - 0.67 * noise;
  }
  std::vector<std::vector<int>> around(wrap.num_vertices());
  for (const Eigen::Vector3i& t : wrap.triangles()) {
    for (int k = 0; k < 3; ++k) around[t[k]].push_back(t[(k + 1) % 3]);
  }
  // Where no point tells, the neighbours do.
  std::vector<double> height(wrap.num_vertices(), 0.0);
  for (int v = 0; v < wrap.num_vertices(); ++v) {
    if (heights[v]) height[v] = *heights[v];
  }
  for (int round = 0; round < kSmoothings; ++round) {
    std::vector<double> next = height;
    for (int v = 0; v < wrap.num_vertices(); ++v) {
      double sum = 0.0;
      for (const int w : around[v]) sum += height[w];
      next[v] =
          0.5 * height[v] + 0.5 * sum / static_cast<double>(around[v].size());
    }
    height = std::move(next);
  }
  std::vector<Eigen::Vector3d> vertices = wrap.vertices();
  const KdTree tree(wrap.vertices());
  for (int v = 0; v < wrap.num_vertices(); ++v) {
    const Eigen::Vector3d& p = wrap.vertices()[v];
    // Half the way to the surface's other side, less what a wall keeps.
    double most = std::numeric_limits<double>::infinity();
    for (const auto& n : tree.FindWithin(p, 4.0 * reach)) {
      const Eigen::Vector3d d = p - wrap.vertices()[n.index];
      const double behind = d.dot(normals[v]);
      if (normals[v].dot(normals[n.index]) < -0.3 && behind > 0.0 &&
          (d - behind * normals[v]).norm() < radius) {
        most = std::min(most, 0.5 * behind - kLeastHalf);
      }
    }
    vertices[v] += std::max(height[v], -most) * normals[v];
  }
  // Taubin's smoothing (1995): shrinks nothing.
  for (int round = 0; round < 2 * kSmoothings; ++round) {
    const double weight = round % 2 == 0 ? 0.5 : -0.53;
    std::vector<Eigen::Vector3d> next = vertices;
    for (int v = 0; v < wrap.num_vertices(); ++v) {
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (const int w : around[v]) mean += vertices[w];
      next[v] +=
          weight * (mean / static_cast<double>(around[v].size()) - vertices[v]);
    }
    vertices = std::move(next);
  }
  return TriangleMesh(std::move(vertices), wrap.triangles());
}

}  // namespace

Result<ReconstructedSurface> ReconstructSurface(const Points& given_O) {
  const Points points_O = DropCopies(given_O);
  if (std::ssize(points_O) < kFewestPoints) {
    return MakeError(
        fmt::format("a cloud of {} different points is too thin; at least "
                    "{} are needed",
                    points_O.size(), kFewestPoints));
  }
  ReconstructedSurface result;
  const Points kept = DropOutliers(points_O);
  CloudReport& report = result.report;
  report.num_points = static_cast<int>(given_O.size());
  report.num_outliers = static_cast<int>(points_O.size() - kept.size());
  if (std::ssize(kept) < kFewestPoints) {
    return MakeError(
        fmt::format("only {} of the cloud's {} points lie "
                    "together; at least {} are needed",
                    kept.size(), points_O.size(), kFewestPoints));
  }
  result.points_O = ThinOut(kept);
  const Points& points = result.points_O;
  report.spacing = CalcSpacing(points);
  report.noise = CalcNoise(points);
  if (!(report.spacing > 0.0)) {
    return MakeError("most of the cloud's points are the same");
  }
  const double offset = kOffset * report.spacing;
  double alpha = kAlpha * report.spacing + 2.0 * report.noise;
  Eigen::Vector3d low = points[0], high = points[0];
  for (const Eigen::Vector3d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  report.one_sided =
      CalcHiddenShare(points, report.spacing, report.noise) < kLeastHiddenShare;
  if (report.one_sided) {
    alpha = std::max(alpha, kOneSidedAlpha * (high - low).norm());
  }
  if (CalcThickness(points) < kFlatness * (high - low).norm()) {
    return MakeError("the cloud's points lie in one plane");
  }
  TriangleMesh wrap = Wrap(points, alpha, offset);
  // Where the wrap got in through a hole among the points, or where there are
  // points on one side only, it encloses nothing but itself.
  const auto is_hollow = [&] {
    const Thinness thin = CalcThinness(wrap, points, offset, report.noise);
    return thin.share > kThinShare &&
           (report.one_sided || thin.gap < kHollowGap * offset);
  };
  while (is_hollow() && kGrowth * alpha < (high - low).norm()) {
    alpha *= kGrowth;
    wrap = Wrap(points, alpha, offset);
  }
  // What bridges much is coarse.
  wrap = SubdivideTo(std::move(wrap), 2.5 * report.spacing);
  result.mesh_O = DrawBack(wrap, points, report.spacing, offset, report.noise);
  if (report.num_outliers > 0) {
    result.steps.push_back(
        fmt::format("dropped {} outlying points", report.num_outliers));
  }
  if (points.size() < kept.size()) {
    result.steps.push_back(
        fmt::format("thinned {} points out to {}", kept.size(), points.size()));
  }
  result.steps.push_back(
      fmt::format("wrapped {} points, {:.1f} mm apart, closing gaps of up to "
                  "{:.2g} mm",
                  points.size(), 1e3 * report.spacing, 1e3 * alpha));
  return result;
}

}  // namespace graspdb
