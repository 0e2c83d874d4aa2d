#include "engine/quality/epsilon_quality.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/random.h"
#include "engine/math/lanes.h"
#include "engine/math/orthogonal_vector.h"

namespace graspdb {
namespace {

constexpr int kDim = 6;
// Points this close to a facet's plane count as on it.
constexpr double kPlaneTolerance = 3e-11;
// A facet beyond which no point reaches by more than this is the hull's.
constexpr double kReachTolerance = 10 * kPlaneTolerance;
// More than the hull of a hundred wrenches has; a polytope that grows on is
// broken by rounding.
constexpr size_t kMaxFacets = 200000;
// Facets whose memory is kept for the next polytope.
constexpr size_t kMostKept = 16384;
// Spread of the wrenches below which they span no volume.
constexpr double kFlatTolerance = 1e-8;
// A vertex of the first simplex is at least this share as far from the others'
// affine hull as the farthest point.
constexpr double kSlimmest = 0.01;
// The share of the product of five edges' lengths that their minors must come
// to, to be exact enough.
constexpr double kLeastMinors = 3e-4;

// Where a facet meets its neighbour: opposite one of its vertices.
struct Ridge {
  int facet;
  int slot;
};

struct Facet {
  std::array<int, kDim> vertices;
  // ridges[k] lies opposite vertex k, in the neighbour's words.
  std::array<Ridge, kDim> ridges;
  Wrench normal;       // Unit, outward.
  double offset{0.0};  // normal · x = offset on the plane.
  bool seen{false};    // By a point that was added: gone.
};

// An inner approximation of the hull that grows one point at a time. A new one
// takes over the memory of the last.
class ExpandingPolytope {
 public:
  // False when the points do not span six dimensions.
  bool Start(const Wrenches& points) {
    points_ = points;
    if (facets_.size() > kMostKept) std::vector<Facet>().swap(facets_);
    facets_.clear();
    const std::optional<std::array<int, kDim + 1>> simplex = FindSimplex();
    if (!simplex) return false;
    inside_.setZero();
    for (const int i : *simplex) inside_ += points_.col(i) / (kDim + 1);
    // Facet i leaves out vertex i.
    for (int i = 0; i <= kDim; ++i) {
      Facet& facet = facets_.emplace_back();
      for (int k = 0; k < kDim; ++k) {
        const int other = k < i ? k : k + 1;
        facet.vertices[k] = (*simplex)[other];
        facet.ridges[k] = {other, i < other ? i : i - 1};
      }
    }
    return SpanPlanes(0);
  }

  // Opens the facet nearest to the origin until it is one of the hull's.
  // Nothing when rounding has broken the polytope.
  std::optional<double> ExpandTowardsOrigin() {
    // How far the hull's nearest facet is at most.
    double most = std::numeric_limits<double>::infinity();
    queue_.clear();
    Enqueue(0, most);
    while (true) {
      const int nearest = PopNearest();
      if (nearest < 0) return std::nullopt;
      const auto [support, reach] = FindSupport(facets_[nearest]);
      if (support < 0) {
        // To the last digit, which minors may lack.
        if (!SpanPlane(facets_[nearest])) return std::nullopt;
        return facets_[nearest].offset;
      }
      if (reach >= 0.0) most = std::min(most, reach);
      const size_t first_new = facets_.size();
      if (!AddPoint(support, nearest)) return std::nullopt;
      Enqueue(first_new, most);
    }
  }

  // Opens every facet; nothing when rounding has broken the polytope.
  std::optional<double> ExpandFully() {
    for (size_t f = 0; f < facets_.size(); ++f) {
      while (!facets_[f].seen) {
        const int support = FindSupport(facets_[f]).first;
        if (support < 0) break;
        if (!AddPoint(support, static_cast<int>(f))) return std::nullopt;
      }
    }
    double volume = 0.0;
    for (const Facet& facet : facets_) {
      if (facet.seen) continue;
      Eigen::Matrix<double, kDim, kDim> edges;
      for (int k = 0; k < kDim; ++k) {
        edges.col(k) = points_.col(facet.vertices[k]) - inside_;
      }
      volume += std::abs(edges.determinant()) / 720.0;
    }
    return volume;
  }

 private:
  // Seven points about the origin, as far as there are such: each the farthest
  // towards it, but none near to the others' affine hull.
  std::optional<std::array<int, kDim + 1>> FindSimplex() {
    if (points_.cols() <= kDim) return std::nullopt;
    std::array<int, kDim + 1> simplex;
    points_.row(0).maxCoeff(&simplex[0]);
    const Wrench first = points_.col(simplex[0]);
    // Without their parts in the affine hull of those that are chosen.
    rest_ = points_.colwise() - first;
    Wrench to_origin = -first;
    for (int k = 1; k <= kDim; ++k) {
      int farthest = 0;
      const double spread = rest_.colwise().squaredNorm().maxCoeff(&farthest);
      if (spread < kFlatTolerance * kFlatTolerance) return std::nullopt;
      share_.noalias() = to_origin.transpose() * rest_;
      share_.maxCoeff(&simplex[k]);
      if (rest_.col(simplex[k]).squaredNorm() <
          kSlimmest * kSlimmest * spread) {
        simplex[k] = farthest;
      }
      const Wrench direction = rest_.col(simplex[k]).normalized();
      share_.noalias() = direction.transpose() * rest_;
      rest_.noalias() -= direction * share_;
      to_origin -= direction * direction.dot(to_origin);
    }
    return simplex;
  }

  // The facet's plane from its vertices, by elimination; false when they do not
  // span one.
  bool SpanPlane(Facet& facet) const {
    Eigen::Matrix<double, kDim - 1, kDim> edges;
    const Wrench base = points_.col(facet.vertices[0]);
    for (int k = 1; k < kDim; ++k) {
      edges.row(k - 1) = points_.col(facet.vertices[k]) - base;
    }
    const std::optional<Wrench> normal = CalcOrthogonalByElimination(edges);
    if (!normal) return false;
    facet.normal = *normal;
    facet.offset = facet.normal.dot(base);
    if (facet.normal.dot(inside_) > facet.offset) {
      facet.normal = -facet.normal;
      facet.offset = -facet.offset;
    }
    return true;
  }

  // The planes of the facets from the first new one on.
  bool SpanPlanes(size_t first_new) {
    for (size_t f = first_new; f < facets_.size(); f += 2) {
      const size_t g = std::min(f + 1, facets_.size() - 1);
      if (!SpanTwoPlanes({&facets_[f], &facets_[g]})) return false;
    }
    return true;
  }

  // Side by side and by minors, where those are exact enough.
  bool SpanTwoPlanes(const std::array<Facet*, 2>& two) const {
    Doubles2 base[kDim];
    Doubles2 edges[kDim - 1][kDim];
    Doubles2 least = Doubles2{} + kLeastMinors * kLeastMinors;
    for (int k = 0; k < kDim; ++k) {
      const double* const p = points_.col(two[0]->vertices[k]).data();
      const double* const q = points_.col(two[1]->vertices[k]).data();
      Doubles2* const edge = k == 0 ? base : edges[k - 1];
      for (int i = 0; i < kDim; ++i) edge[i] = Doubles2{p[i], q[i]};
      if (k == 0) continue;
      for (int i = 0; i < kDim; ++i) edge[i] -= base[i];
      least *= CalcDot(edge, edge);
    }
    Doubles2 normal[kDim];
    CalcOrthogonalByMinors(edges, normal);
    const Doubles2 squared = CalcDot(normal, normal);
    const Doubles2 offset = CalcDot(normal, base);
    const Doubles2 inside = CalcDot(normal, inside_.data());
    for (int lane = 0; lane < 2; ++lane) {
      Facet& facet = *two[lane];
      if (!(squared[lane] > least[lane])) {
        if (!SpanPlane(facet)) return false;
        continue;
      }
      const double scale = std::copysign(1.0 / std::sqrt(squared[lane]),
                                         offset[lane] - inside[lane]);
      for (int i = 0; i < kDim; ++i) facet.normal[i] = scale * normal[i][lane];
      facet.offset = scale * offset[lane];
    }
    return true;
  }

  template <class Numbers>
  static Doubles2 CalcDot(const Doubles2* a, const Numbers* b) {
    Doubles2 sum{};
    for (int i = 0; i < kDim; ++i) sum += a[i] * b[i];
    return sum;
  }

  // Queues the facets from the first new one on that may be the hull's nearest.
  void Enqueue(size_t first_new, double most) {
    for (size_t f = first_new; f < facets_.size(); ++f) {
      if (facets_[f].offset > most + kReachTolerance) continue;
      queue_.emplace_back(facets_[f].offset, static_cast<int>(f));
      std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
    }
  }

  int PopNearest() {
    while (!queue_.empty()) {
      std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
      const int index = queue_.back().second;
      queue_.pop_back();
      if (!facets_[index].seen) return index;
    }
    return -1;
  }

  // The point farthest beyond the facet, or -1; and how far the hull reaches
  // along its normal.
  std::pair<int, double> FindSupport(const Facet& facet) {
    reach_.noalias() = points_.transpose() * facet.normal;
    int support = 0;
    const double reach = reach_.maxCoeff(&support);
    return {reach > facet.offset + kReachTolerance ? support : -1, reach};
  }

  bool Sees(int point, const Facet& facet) const {
    return facet.normal.dot(points_.col(point)) >
           facet.offset - kPlaneTolerance;
  }

  // Replaces the facets that the point sees by a cone over their horizon. False
  // when rounding has broken the polytope.
  bool AddPoint(int point, int first_seen) {
    if (facets_.size() > kMaxFacets) return false;
    FindHorizon(point, first_seen);
    const size_t first_new = facets_.size();
    return MakeCone(point) && SpanPlanes(first_new);
  }

  // Marks what the point sees, and lists the ridges between that and the rest.
  void FindHorizon(int point, int first_seen) {
    Facet* const facets = facets_.data();
    horizon_.clear();
    seen_.assign(1, first_seen);
    facets[first_seen].seen = true;
    for (size_t i = 0; i < seen_.size(); ++i) {
      const int f = seen_[i];
      for (int k = 0; k < kDim; ++k) {
        const int next = facets[f].ridges[k].facet;
        if (facets[next].seen) continue;
        if (Sees(point, facets[next])) {
          facets[next].seen = true;
          seen_.push_back(next);
        } else {
          horizon_.push_back({f, k});
        }
      }
    }
  }

  // One facet per ridge of the horizon, which takes the place of the one beyond
  // it as the neighbour of the one that is seen; its plane is yet to be found.
  bool MakeCone(int point) {
    const auto first_new = static_cast<int>(facets_.size());
    const auto num_new = static_cast<int>(horizon_.size());
    facets_.resize(first_new + num_new);
    Facet* const facets = facets_.data();
    for (int i = 0; i < num_new; ++i) {
      const auto [f, slot] = horizon_[i];
      Facet& facet = facets[first_new + i];
      const Ridge beyond = facets[f].ridges[slot];
      facet.vertices = facets[f].vertices;
      facet.vertices[slot] = point;
      facet.ridges.fill({-1, 0});
      facet.ridges[slot] = beyond;
      const Ridge base{first_new + i, slot};
      facets[beyond.facet].ridges[beyond.slot] = base;
      facets[f].ridges[slot] = base;
    }
    for (int i = 0; i < num_new; ++i) {
      Facet& facet = facets[first_new + i];
      for (int k = 0; k < kDim; ++k) {
        if (facet.ridges[k].facet >= 0) continue;
        const Ridge other = FindNeighbour(horizon_[i], k);
        if (other.facet < 0) return false;
        facet.ridges[k] = other;
        facets[other.facet].ridges[other.slot] = {first_new + i, k};
      }
    }
    return true;
  }

  // The ridge that the new facet over one of the horizon has opposite its
  // vertex k, as the neighbour there has it: around what they share, through
  // facets that are seen, to where the horizon is met again. No facet when
  // rounding has broken the polytope.
  Ridge FindNeighbour(const Ridge& ridge, int k) const {
    const Facet* const facets = facets_.data();
    const Facet* from = &facets[ridge.facet];
    int entered = ridge.slot;
    int leave = k;
    for (size_t turn = 0; turn < seen_.size(); ++turn) {
      const Ridge next = from->ridges[leave];
      const Facet& facet = facets[next.facet];
      // A new facet has its vertices in the slots of the one it was made over.
      if (!facet.seen) return {next.facet, entered};
      leave = FindSlot(facet, from->vertices[entered]);
      if (leave == kDim) break;
      from = &facet;
      entered = next.slot;
    }
    return {-1, 0};
  }

  // Without a branch that depends on the data.
  static int FindSlot(const Facet& facet, int vertex) {
    unsigned found = 1u << kDim;
    for (int k = 0; k < kDim; ++k) {
      found |= static_cast<unsigned>(facet.vertices[k] == vertex) << k;
    }
    return std::countr_zero(found);
  }

  Wrenches points_;
  Wrench inside_;
  std::vector<Facet> facets_;
  std::vector<std::pair<double, int>> queue_;  // A heap, the nearest on top.
  // Between the calls only to keep their memory.
  Wrenches rest_;
  Eigen::RowVectorXd share_;
  Eigen::VectorXd reach_;
  std::vector<int> seen_;
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
