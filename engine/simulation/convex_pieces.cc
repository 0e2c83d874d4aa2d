#include "engine/simulation/convex_pieces.h"

#include <algorithm>
#include <numeric>
#include <queue>
#include <set>
#include <utility>

#include "engine/base/contract.h"
#include "engine/geometry/surface_index.h"

namespace graspdb {
namespace {

constexpr double kLeastStep = 0.0005;   // Through the solid, m.
constexpr double kLeastDepth = 0.0005;  // Of a piece, m.
constexpr double kLongChord = 0.02;     // Is looked at in more places, m.
constexpr int kMostPoints = 24;         // That a new one is compared with.

// Grows patches over a surface while their hulls stay within the solid.
class Grower {
 public:
  Grower(const TriangleMesh& mesh, double concavity, double depth)
      : mesh_(mesh), index_(mesh), concavity_(concavity) {
    for (int f = 0; f < mesh.num_triangles(); ++f) {
      thickness_.push_back(CalcThickness(f, depth));
      for (int k = 0; k < 3; ++k) edges_.push_back({MakeEdge(f, k), f});
    }
    std::sort(edges_.begin(), edges_.end());
    taken_.assign(static_cast<size_t>(mesh.num_triangles()), false);
  }

  std::vector<std::vector<Eigen::Vector3d>> Run() {
    std::vector<int> seeds(static_cast<size_t>(mesh_.num_triangles()));
    std::iota(seeds.begin(), seeds.end(), 0);
    std::stable_sort(seeds.begin(), seeds.end(), [&](int a, int b) {
      return mesh_.area(a) > mesh_.area(b);
    });
    std::vector<std::vector<Eigen::Vector3d>> pieces;
    for (const int seed : seeds) {
      if (!taken_[static_cast<size_t>(seed)]) pieces.push_back(Grow(seed));
    }
    return pieces;
  }

 private:
  using Edge = std::pair<int, int>;

  Edge MakeEdge(int f, int k) const {
    const Eigen::Vector3i& t = mesh_.triangles()[static_cast<size_t>(f)];
    return std::minmax(t[k], t[(k + 1) % 3]);
  }

  // How far one can go inwards from the middle of a face.
  double CalcThickness(int f, double depth) const {
    double way = kLeastStep;
    while (way < depth) {
      const double inside =
          -index_.CalcSignedDistance(mesh_.centroid(f) - way * mesh_.normal(f));
      if (inside <= 0.0) break;
      // From halfway on the far side is the nearest.
      way += std::max(inside, kLeastStep);
    }
    way = std::clamp(way, kLeastDepth, depth);
    // It may be thinner at the corners than in the middle.
    const auto bulges = [&](double by) {
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d& a = mesh_.corner(f, k);
        const Eigen::Vector3d& b = mesh_.corner(f, (k + 1) % 3);
        if (StandsOut(a - by * mesh_.normal(f)) ||
            StandsOut(0.5 * (a + b) - by * mesh_.normal(f))) {
          return true;
        }
      }
      return false;
    };
    while (way > kLeastDepth && bulges(way)) way *= 0.5;
    return way;
  }

  bool StandsOut(const Eigen::Vector3d& p) const {
    return index_.CalcSignedDistance(p) > concavity_;
  }

  bool ChordStandsOut(const Eigen::Vector3d& a,
                      const Eigen::Vector3d& b) const {
    if (StandsOut(0.5 * (a + b))) return true;
    if ((a - b).norm() < kLongChord) return false;
    return StandsOut(0.75 * a + 0.25 * b) || StandsOut(0.25 * a + 0.75 * b);
  }

  // Whether the hull of the points and a new one would stand out of the solid.
  bool Bulges(const std::vector<Eigen::Vector3d>& points,
              const Eigen::Vector3d& added) const {
    const size_t step = points.size() / kMostPoints + 1;
    for (size_t i = 0; i < points.size(); i += step) {
      if (ChordStandsOut(points[i], added)) return true;
      const Eigen::Vector3d& other =
          points[(i + points.size() / 2) % points.size()];
      if (StandsOut((points[i] + other + added) / 3.0)) return true;
    }
    return false;
  }

  // The patch around a face, of faces that have none yet.
  std::vector<Eigen::Vector3d> Grow(int seed) {
    std::vector<Eigen::Vector3d> outer;  // On the surface …
    std::vector<Eigen::Vector3d> inner;  // … and the same moved into the solid.
    std::set<int> vertices;
    std::set<int> tried{seed};
    using Entry = std::pair<double, int>;  // Nearest to the seed first.
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    queue.emplace(0.0, seed);
    while (!queue.empty()) {
      const int f = queue.top().second;
      queue.pop();
      const Eigen::Vector3d inwards =
          -thickness_[static_cast<size_t>(f)] * mesh_.normal(f);
      const Eigen::Vector3i& corners =
          mesh_.triangles()[static_cast<size_t>(f)];
      const bool fits = std::all_of(corners.begin(), corners.end(), [&](int v) {
        const Eigen::Vector3d& p = mesh_.vertices()[static_cast<size_t>(v)];
        return vertices.contains(v) ||
               !(Bulges(outer, p) || Bulges(inner, p + inwards) ||
                 Bulges(outer, p + inwards) || Bulges(inner, p));
      });
      if (f != seed && !fits) continue;
      taken_[static_cast<size_t>(f)] = true;
      for (const int v : corners) {
        if (!vertices.insert(v).second) continue;
        outer.push_back(mesh_.vertices()[static_cast<size_t>(v)]);
        inner.push_back(outer.back() + inwards);
      }
      for (int k = 0; k < 3; ++k) {
        const Edge edge = MakeEdge(f, k);
        for (auto i = std::lower_bound(edges_.begin(), edges_.end(),
                                       std::pair(edge, 0));
             i != edges_.end() && i->first == edge; ++i) {
          const int next = i->second;
          if (taken_[static_cast<size_t>(next)] || !tried.insert(next).second) {
            continue;
          }
          queue.emplace((mesh_.centroid(next) - mesh_.centroid(seed)).norm(),
                        next);
        }
      }
    }
    outer.insert(outer.end(), inner.begin(), inner.end());
    return outer;
  }

  const TriangleMesh& mesh_;
  const SurfaceIndex index_;
  const double concavity_;
  std::vector<double> thickness_;            // Per face, m.
  std::vector<std::pair<Edge, int>> edges_;  // With a face, sorted.
  std::vector<bool> taken_;                  // Whether a face has a piece.
};

}  // namespace

std::vector<std::vector<Eigen::Vector3d>> MakeConvexPieces(
    const TriangleMesh& mesh_O, double concavity, double depth) {
  GRASPDB_EXPECTS(concavity > 0.0 && depth > 0.0);
  return Grower(mesh_O, concavity, depth).Run();
}

}  // namespace graspdb
