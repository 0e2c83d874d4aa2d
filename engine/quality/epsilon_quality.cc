#include "engine/quality/epsilon_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include "engine/base/contract.h"
#include "engine/base/random.h"

namespace graspdb {
namespace {

constexpr int kDim = 6;
// Points this close to a facet's plane count as on it.
constexpr double kPlaneTolerance = 1e-11;
// More than the hull of a hundred wrenches has; a polytope that grows on is
// broken by rounding.
constexpr size_t kMaxFacets = 200000;
// Spread of the wrenches below which they span no volume.
constexpr double kFlatTolerance = 1e-8;

struct Facet {
  std::array<int, kDim> vertices;
  std::array<int, kDim> neighbours;  // neighbours[k] lies opposite vertex k.
  Wrench normal;                     // Unit, outward.
  double offset{0.0};                // normal · x = offset on the plane.
  bool alive{true};
  bool visited{false};
};

// The unit vector orthogonal to five rows, by elimination with full pivoting;
// nothing when they are dependent.
std::optional<Wrench> CalcOrthogonal(
    Eigen::Matrix<double, kDim - 1, kDim>& rows) {
  std::array<int, kDim> column{0, 1, 2, 3, 4, 5};
  for (int k = 0; k < kDim - 1; ++k) {
    int row = k, pivot = k;
    double largest = 0.0;
    for (int i = k; i < kDim - 1; ++i) {
      for (int j = k; j < kDim; ++j) {
        const double size = std::abs(rows(i, column[j]));
        if (size > largest) {
          largest = size;
          row = i;
          pivot = j;
        }
      }
    }
    if (largest < 1e-14) return std::nullopt;
    if (row != k) rows.row(row).swap(rows.row(k));
    std::swap(column[k], column[pivot]);
    for (int i = k + 1; i < kDim - 1; ++i) {
      const double factor = rows(i, column[k]) / rows(k, column[k]);
      if (factor == 0.0) continue;
      for (int j = k; j < kDim; ++j) {
        rows(i, column[j]) -= factor * rows(k, column[j]);
      }
    }
  }
  Wrench normal;
  normal[column[kDim - 1]] = 1.0;
  for (int k = kDim - 2; k >= 0; --k) {
    double sum = 0.0;
    for (int j = k + 1; j < kDim; ++j) {
      sum += rows(k, column[j]) * normal[column[j]];
    }
    normal[column[k]] = -sum / rows(k, column[k]);
  }
  return normal.normalized();
}

// An inner approximation of the hull that grows one point at a time.
class ExpandingPolytope {
 public:
  explicit ExpandingPolytope(const Wrenches& points) : points_(points) {
    GRASPDB_EXPECTS(points.cols() < 1 << 16);
  }

  // False when the points do not span six dimensions.
  bool Start() {
    const std::optional<std::array<int, kDim + 1>> simplex = FindSimplex();
    if (!simplex) return false;
    inside_.setZero();
    for (const int i : *simplex) inside_ += points_.col(i) / (kDim + 1);
    for (int k = 0; k <= kDim; ++k) {
      Facet facet;
      int slot = 0;
      for (int i = 0; i <= kDim; ++i) {
        if (i == k) continue;
        facet.vertices[slot] = (*simplex)[i];
        facet.neighbours[slot] = i;  // Facet i leaves out vertex i.
        ++slot;
      }
      if (!AddFacet(facet)) return false;
    }
    return true;
  }

  // Opens the facet nearest to the origin until it is one of the hull's.
  // Nothing when rounding has broken the polytope.
  std::optional<double> ExpandTowardsOrigin() {
    while (true) {
      const int nearest = PopNearest();
      if (nearest < 0) return std::nullopt;
      const int support = FindSupport(nearest);
      if (support < 0) return facets_[nearest].offset;
      if (facets_.size() > kMaxFacets) return std::nullopt;
      if (!AddPoint(support, nearest)) return std::nullopt;
    }
  }

  // Opens every facet; nothing when rounding has broken the polytope.
  std::optional<double> ExpandFully() {
    for (size_t f = 0; f < facets_.size(); ++f) {
      while (facets_[f].alive) {
        const int support = FindSupport(static_cast<int>(f));
        if (support < 0) break;
        if (facets_.size() > kMaxFacets) return std::nullopt;
        if (!AddPoint(support, static_cast<int>(f))) return std::nullopt;
      }
    }
    double volume = 0.0;
    for (const Facet& facet : facets_) {
      if (!facet.alive) continue;
      Eigen::Matrix<double, kDim, kDim> edges;
      for (int k = 0; k < kDim; ++k) {
        edges.col(k) = points_.col(facet.vertices[k]) - inside_;
      }
      volume += std::abs(edges.determinant()) / 720.0;
    }
    return volume;
  }

 private:
  // Seven points that are far from each other's affine hull.
  std::optional<std::array<int, kDim + 1>> FindSimplex() const {
    if (points_.cols() <= kDim) return std::nullopt;
    std::array<int, kDim + 1> simplex;
    points_.row(0).maxCoeff(&simplex[0]);
    const Wrench origin = points_.col(simplex[0]);
    Wrenches rest = points_.colwise() - origin;
    for (int k = 1; k <= kDim; ++k) {
      const double spread = rest.colwise().squaredNorm().maxCoeff(&simplex[k]);
      if (spread < kFlatTolerance * kFlatTolerance) return std::nullopt;
      const Wrench direction = rest.col(simplex[k]).normalized();
      rest -= direction * (direction.transpose() * rest).eval();
    }
    return simplex;
  }

  bool AddFacet(Facet facet) {
    Eigen::Matrix<double, kDim - 1, kDim> edges;
    const Wrench base = points_.col(facet.vertices[0]);
    for (int k = 1; k < kDim; ++k) {
      edges.row(k - 1) = points_.col(facet.vertices[k]) - base;
    }
    const std::optional<Wrench> normal = CalcOrthogonal(edges);
    if (!normal) return false;
    facet.normal = *normal;
    facet.offset = facet.normal.dot(base);
    if (facet.normal.dot(inside_) > facet.offset) {
      facet.normal = -facet.normal;
      facet.offset = -facet.offset;
    }
    const int index = static_cast<int>(facets_.size());
    facets_.push_back(facet);
    queue_.emplace(facet.offset, index);
    return true;
  }

  int PopNearest() {
    while (!queue_.empty()) {
      const int index = queue_.top().second;
      queue_.pop();
      if (facets_[index].alive) return index;
    }
    return -1;
  }

  // The point farthest beyond the facet, or -1.
  int FindSupport(int f) const {
    int support = 0;
    const double reach =
        (facets_[f].normal.transpose() * points_).maxCoeff(&support);
    return reach > facets_[f].offset + 10 * kPlaneTolerance ? support : -1;
  }

  bool Sees(int point, const Facet& facet) const {
    return facet.normal.dot(points_.col(point)) >
           facet.offset - kPlaneTolerance;
  }

  // Replaces the facets that the point sees by a cone over their horizon.
  bool AddPoint(int point, int first_visible) {
    std::vector<int> visible{first_visible};
    facets_[first_visible].visited = true;
    std::vector<std::pair<int, int>> horizon;  // Visible facet, slot.
    for (size_t i = 0; i < visible.size(); ++i) {
      for (int k = 0; k < kDim; ++k) {
        const int next = facets_[visible[i]].neighbours[k];
        if (facets_[next].visited) continue;
        if (Sees(point, facets_[next])) {
          facets_[next].visited = true;
          visible.push_back(next);
        } else {
          horizon.emplace_back(visible[i], k);
        }
      }
    }
    // One facet per ridge of the horizon; new ones meet along ridges that
    // leave out one vertex of theirs.
    struct OpenRidge {
      uint64_t vertices;  // Sixteen bits each, ascending.
      int facet;
      int slot;
    };
    std::vector<OpenRidge> open;
    for (const auto& [seen, slot] : horizon) {
      const int beyond = facets_[seen].neighbours[slot];
      Facet facet;
      facet.vertices = facets_[seen].vertices;
      facet.vertices[slot] = point;
      facet.neighbours.fill(-1);
      facet.neighbours[slot] = beyond;
      const int index = static_cast<int>(facets_.size());
      if (!AddFacet(facet)) return false;
      std::array<int, kDim>& back = facets_[beyond].neighbours;
      *std::find(back.begin(), back.end(), seen) = index;
      for (int k = 0; k < kDim; ++k) {
        if (k == slot) continue;
        std::array<int, kDim - 2> vertices;
        int n = 0;
        for (int i = 0; i < kDim; ++i) {
          if (i != k && i != slot) vertices[n++] = facet.vertices[i];
        }
        std::sort(vertices.begin(), vertices.end());
        uint64_t key = 0;
        for (const int v : vertices) key = key << 16 | static_cast<uint64_t>(v);
        open.push_back({key, index, k});
      }
    }
    // A ridge's two facets: the order of equal keys does not matter but must
    // not depend on the sort.
    std::sort(open.begin(), open.end(),
              [](const OpenRidge& a, const OpenRidge& b) {
                return a.vertices != b.vertices ? a.vertices < b.vertices
                                                : a.facet < b.facet;
              });
    if (open.size() % 2 != 0) return false;
    for (size_t i = 0; i < open.size(); i += 2) {
      const OpenRidge& a = open[i];
      const OpenRidge& b = open[i + 1];
      if (a.vertices != b.vertices) return false;
      facets_[a.facet].neighbours[a.slot] = b.facet;
      facets_[b.facet].neighbours[b.slot] = a.facet;
    }
    for (const int f : visible) facets_[f].alive = false;
    return true;
  }

  const Wrenches& points_;
  Wrench inside_;
  std::vector<Facet> facets_;
  std::priority_queue<std::pair<double, int>,
                      std::vector<std::pair<double, int>>, std::greater<>>
      queue_;
};

// Runs `measure` on the wrenches, and should rounding break the polytope, on
// copies that are shaken by less than the accuracy promised.
template <class Measure>
double MeasureHull(const Wrenches& wrenches, double if_flat,
                   const Measure& measure) {
  Wrenches points = wrenches;
  Random random(1);
  for (double shake = 1e-11; shake < 1e-6; shake *= 100.0) {
    ExpandingPolytope polytope(points);
    if (!polytope.Start()) return if_flat;
    if (const std::optional<double> value = measure(polytope)) return *value;
    for (int i = 0; i < points.cols(); ++i) {
      for (int k = 0; k < kDim; ++k) {
        points(k, i) = wrenches(k, i) + random.NextUniform(-shake, shake);
      }
    }
  }
  return if_flat;
}

}  // namespace

double CalcEpsilonQuality(const Wrenches& wrenches) {
  return MeasureHull(wrenches, -1.0, [](ExpandingPolytope& polytope) {
    return polytope.ExpandTowardsOrigin();
  });
}

double CalcWrenchVolume(const Wrenches& wrenches) {
  return MeasureHull(wrenches, 0.0, [](ExpandingPolytope& polytope) {
    return polytope.ExpandFully();
  });
}

}  // namespace graspdb
