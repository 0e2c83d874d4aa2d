#include "server/bench/scanned_cloud.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include <fmt/format.h>

#include "engine/base/contract.h"
#include "engine/base/random.h"

namespace graspdb {
namespace {

// Samples drawn at most for a point that the camera sees.
constexpr int kMostTries = 200;
// What is nearer to a point than this does not hide it, m.
constexpr double kOwnSurface = 1e-5;

// Whether the ray from p along d meets the triangle [Moeller, Trumbore 1997].
bool Meets(const Eigen::Vector3d& p, const Eigen::Vector3d& d,
           const Eigen::Vector3d& a, const Eigen::Vector3d& b,
           const Eigen::Vector3d& c) {
  const Eigen::Vector3d h = d.cross(c - a);
  const double det = (b - a).dot(h);
  if (std::abs(det) < 1e-18) return false;
  const double u = (p - a).dot(h) / det;
  if (u < 0.0 || u > 1.0) return false;
  const Eigen::Vector3d q = (p - a).cross(b - a);
  const double v = d.dot(q) / det;
  return v >= 0.0 && u + v <= 1.0 && (c - a).dot(q) / det > kOwnSurface;
}

bool IsSeen(const TriangleMesh& mesh, int face, const Eigen::Vector3d& p,
            const Eigen::Vector3d& camera) {
  if (mesh.normal(face).dot(camera) <= 0.0) return false;
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    if (f != face && Meets(p, camera, mesh.corner(f, 0), mesh.corner(f, 1),
                           mesh.corner(f, 2))) {
      return false;
    }
  }
  return true;
}

// The faces of a label, with the areas summed up.
struct Region {
  std::vector<int> faces;
  std::vector<double> sums;
};

Region CollectRegion(const TriangleMesh& mesh, const std::vector<int>& labels,
                     int label) {
  Region region;
  double sum = 0.0;
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    if (labels[static_cast<size_t>(f)] != label) continue;
    sum += mesh.area(f);
    region.faces.push_back(f);
    region.sums.push_back(sum);
  }
  return region;
}

}  // namespace

std::vector<Eigen::Vector3d> ScanSurface(const TriangleMesh& mesh_O,
                                         const std::vector<int>& labels,
                                         const ScanOptions& options) {
  GRASPDB_EXPECTS(std::ssize(labels) == mesh_O.num_triangles());
  std::vector<Eigen::Vector3d> points;
  Random random(options.seed);
  for (size_t label = 0; label < options.points_by_label.size(); ++label) {
    const Region region =
        CollectRegion(mesh_O, labels, static_cast<int>(label));
    const int wanted = options.points_by_label[label];
    if (region.faces.empty()) continue;
    int taken = 0;
    for (int tries = 0; taken < wanted && tries < kMostTries * wanted;
         ++tries) {
      const double area = random.NextUniform() * region.sums.back();
      const auto at = static_cast<size_t>(
          std::upper_bound(region.sums.begin(), region.sums.end() - 1, area) -
          region.sums.begin());
      const int face = region.faces[at];
      const double u = std::sqrt(random.NextUniform());
      const double v = random.NextUniform();
      const Eigen::Vector3d p = (1.0 - u) * mesh_O.corner(face, 0) +
                                u * (1.0 - v) * mesh_O.corner(face, 1) +
                                u * v * mesh_O.corner(face, 2);
      if (options.camera_O && !IsSeen(mesh_O, face, p, *options.camera_O)) {
        continue;
      }
      ++taken;
      points.push_back(p +
                       options.noise * Eigen::Vector3d(random.NextNormal(),
                                                       random.NextNormal(),
                                                       random.NextNormal()));
    }
  }
  return points;
}

std::string FormatXyz(const std::vector<Eigen::Vector3d>& points) {
  std::string text;
  for (const Eigen::Vector3d& p : points) {
    text += fmt::format("{:.6f} {:.6f} {:.6f}\n", p.x(), p.y(), p.z());
  }
  return text;
}

}  // namespace graspdb
