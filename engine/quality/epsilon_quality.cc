#include "engine/quality/epsilon_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/random.h"

namespace graspdb {
namespace {

constexpr int kDim = 6;
// Points this close to a facet's plane count as on it.
constexpr double kPlaneTolerance = 3e-11;
// More than the hull of a hundred wrenches has; a polytope that grows on is
// broken by rounding.
constexpr size_t kMaxFacets = 200000;
// Facets whose memory is kept for the next polytope.
constexpr size_t kMostKept = 16384;
// What a plane that was spanned by its points may be off at a point of the
// hull, and what one may be that follows from other planes.
constexpr double kSpanError = 1e-15;
constexpr double kMostError = 0.3 * kPlaneTolerance;
// Spread of the wrenches below which they span no volume.
constexpr double kFlatTolerance = 1e-8;

struct Facet {
  std::array<int, kDim> vertices;
  std::array<int, kDim> neighbours;  // neighbours[k] lies opposite vertex k.
  Wrench normal;                     // Unit, outward.
  double offset{0.0};                // normal · x = offset on the plane …
  double error{0.0};                 // … but for at most this.
  bool alive{true};
  bool visited{false};
};

// Where a facet meets its neighbour opposite one of its vertices.
struct Ridge {
  int facet;
  int slot;
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

// An inner approximation of the hull that grows one point at a time. A new one
// takes over the memory of the last.
class ExpandingPolytope {
 public:
  // False when the points do not span six dimensions.
  bool Start(const Wrenches& points) {
    points_ = points;
    if (facets_.size() > kMostKept) std::vector<Facet>().swap(facets_);
    facets_.clear();
    queue_.clear();
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
      if (!SpanPlane(facet)) return false;
      AddFacet(facet);
    }
    return true;
  }

  // Opens the facet nearest to the origin until it is one of the hull's.
  // Nothing when rounding has broken the polytope.
  std::optional<double> ExpandTowardsOrigin() {
    while (true) {
      const int nearest = PopNearest();
      if (nearest < 0) return std::nullopt;
      const int support = FindSupport(facets_[nearest]);
      if (support < 0) {
        // Free of what rounding has gathered on the way.
        if (!SpanPlane(facets_[nearest])) return std::nullopt;
        return facets_[nearest].offset;
      }
      if (facets_.size() > kMaxFacets) return std::nullopt;
      if (!AddPoint(support, nearest)) return std::nullopt;
    }
  }

  // Opens every facet; nothing when rounding has broken the polytope.
  std::optional<double> ExpandFully() {
    for (size_t f = 0; f < facets_.size(); ++f) {
      while (facets_[f].alive) {
        const int support = FindSupport(facets_[f]);
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
  std::optional<std::array<int, kDim + 1>> FindSimplex() {
    if (points_.cols() <= kDim) return std::nullopt;
    std::array<int, kDim + 1> simplex;
    points_.row(0).maxCoeff(&simplex[0]);
    const Wrench origin = points_.col(simplex[0]);
    rest_ = points_.colwise() - origin;
    for (int k = 1; k <= kDim; ++k) {
      const double spread = rest_.colwise().squaredNorm().maxCoeff(&simplex[k]);
      if (spread < kFlatTolerance * kFlatTolerance) return std::nullopt;
      const Wrench direction = rest_.col(simplex[k]).normalized();
      share_.noalias() = direction.transpose() * rest_;
      rest_.noalias() -= direction * share_;
    }
    return simplex;
  }

  // The facet's plane from its vertices; false when they do not span one.
  bool SpanPlane(Facet& facet) const {
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
    facet.error = kSpanError;
    return true;
  }

  // The plane through a point and the ridge where a facet that it sees meets
  // one that it does not: of all planes through that ridge, which are sums of
  // the two, the one that holds the point.
  bool CalcPlane(int point, const Facet& seen, const Facet& beyond,
                 Facet& facet) const {
    const Wrench p = points_.col(point);
    const double above = seen.normal.dot(p) - seen.offset;
    const double below = beyond.offset - beyond.normal.dot(p);
    const Wrench sum = above * beyond.normal + below * seen.normal;
    const double length = sum.norm();
    // The planes' own errors, and those of the two distances.
    const double error = above * beyond.error + below * seen.error +
                         4.0 * (beyond.error + seen.error + kSpanError);
    if (error > kMostError * length) return SpanPlane(facet);
    facet.error = error / length;
    facet.normal = sum / length;
    facet.offset = (above * beyond.offset + below * seen.offset) / length;
    return true;
  }

  void AddFacet(const Facet& facet) {
    queue_.emplace_back(facet.offset, static_cast<int>(facets_.size()));
    std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
    facets_.push_back(facet);
  }

  int PopNearest() {
    while (!queue_.empty()) {
      std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
      const int index = queue_.back().second;
      queue_.pop_back();
      if (facets_[index].alive) return index;
    }
    return -1;
  }

  // The point farthest beyond the facet, or -1.
  int FindSupport(const Facet& facet) {
    reach_.noalias() = points_.transpose() * facet.normal;
    int support = 0;
    const double reach = reach_.maxCoeff(&support);
    return reach > facet.offset + 10 * kPlaneTolerance ? support : -1;
  }

  bool Sees(int point, const Facet& facet) const {
    return facet.normal.dot(points_.col(point)) >
           facet.offset - kPlaneTolerance;
  }

  // Replaces the facets that the point sees by a cone over their horizon. False
  // when rounding has broken the polytope.
  bool AddPoint(int point, int first_visible) {
    visible_.assign(1, first_visible);
    facets_[first_visible].visited = true;
    horizon_.clear();
    for (size_t i = 0; i < visible_.size(); ++i) {
      for (int k = 0; k < kDim; ++k) {
        const int next = facets_[visible_[i]].neighbours[k];
        if (facets_[next].visited) continue;
        if (Sees(point, facets_[next])) {
          facets_[next].visited = true;
          visible_.push_back(next);
        } else {
          horizon_.push_back({visible_[i], k});
        }
      }
    }
    // One facet per ridge of the horizon, which takes the place of the one
    // beyond it as the neighbour of the one that is seen.
    const auto first_new = facets_.size();
    for (const Ridge& ridge : horizon_) {
      Facet& seen = facets_[ridge.facet];
      const int beyond = seen.neighbours[ridge.slot];
      const int index = static_cast<int>(facets_.size());
      Facet facet;
      facet.vertices = seen.vertices;
      facet.vertices[ridge.slot] = point;
      facet.neighbours[ridge.slot] = beyond;
      if (!CalcPlane(point, seen, facets_[beyond], facet)) return false;
      std::array<int, kDim>& back = facets_[beyond].neighbours;
      *std::find(back.begin(), back.end(), ridge.facet) = index;
      seen.neighbours[ridge.slot] = index;
      AddFacet(facet);
    }
    for (size_t i = 0; i < horizon_.size(); ++i) {
      Facet& facet = facets_[first_new + i];
      for (int k = 0; k < kDim; ++k) {
        if (k == horizon_[i].slot) continue;
        facet.neighbours[k] = FindNeighbour(horizon_[i], k);
        if (facet.neighbours[k] < 0) return false;
      }
    }
    for (const int f : visible_) facets_[f].alive = false;
    return true;
  }

  // The new facet that shares with the one over a ridge of the horizon all but
  // the vertex in slot k: around what they share, through facets that are seen,
  // to where the horizon is met again. -1 when rounding has broken the
  // polytope.
  int FindNeighbour(const Ridge& ridge, int k) const {
    int from = ridge.facet;
    int left_out = facets_[from].vertices[ridge.slot];
    int next = facets_[from].neighbours[k];
    for (size_t turn = 0; turn < visible_.size(); ++turn) {
      const Facet& facet = facets_[next];
      if (!facet.visited) return next;
      const auto entered =
          std::find(facet.neighbours.begin(), facet.neighbours.end(), from);
      const auto left =
          std::find(facet.vertices.begin(), facet.vertices.end(), left_out);
      if (entered == facet.neighbours.end() || left == facet.vertices.end()) {
        return -1;
      }
      from = next;
      left_out = facet.vertices[entered - facet.neighbours.begin()];
      next = facet.neighbours[left - facet.vertices.begin()];
    }
    return facets_[next].visited ? -1 : next;
  }

  Wrenches points_;
  Wrench inside_;
  std::vector<Facet> facets_;
  std::vector<std::pair<double, int>> queue_;  // A heap, the nearest on top.
  // Between the calls only to keep their memory.
  Wrenches rest_;
  Eigen::RowVectorXd share_;
  Eigen::VectorXd reach_;
  std::vector<int> visible_;
  std::vector<Ridge> horizon_;
};

// Runs `measure` on the wrenches, and should rounding break the polytope, on
// copies that are shaken by less than the accuracy promised.
template <class Measure>
double MeasureHull(const Wrenches& wrenches, double if_flat,
                   const Measure& measure) {
  thread_local ExpandingPolytope polytope;
  if (!polytope.Start(wrenches)) return if_flat;
  if (const std::optional<double> value = measure(polytope)) return *value;
  Wrenches points = wrenches;
  Random random(1);
  for (const double shake : {1e-11, 1e-11 * 100.0}) {
    for (int i = 0; i < points.cols(); ++i) {
      for (int k = 0; k < kDim; ++k) {
        points(k, i) = wrenches(k, i) + random.NextUniform(-shake, shake);
      }
    }
    if (!polytope.Start(points)) return if_flat;
    if (const std::optional<double> value = measure(polytope)) return *value;
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
