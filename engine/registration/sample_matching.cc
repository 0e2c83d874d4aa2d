#include "engine/registration/sample_matching.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "engine/base/contract.h"
#include "engine/math/lanes.h"

namespace graspdb {
namespace {

// One column per sample. At a few hundred to a few thousand samples a search of
// all pairs, many at a time, is faster than any tree.
using Cloud = Eigen::Matrix<float, 6, Eigen::Dynamic>;

constexpr double kResidualCap = 0.5;  // Squared rms radii.
constexpr double kRobustWidth = 0.3;  // Squared rms radii.

Cloud MakeCloud(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& normals,
                double normal_weight) {
  Cloud cloud(6, points.cols());
  cloud.topRows<3>() = points.cast<float>();
  cloud.bottomRows<3>() = (normal_weight * normals).cast<float>();
  return cloud;
}

// A point's coordinates and half its square.
using PackedCloud = Eigen::Matrix<float, 7, Eigen::Dynamic>;

// The nearest point p of each query q maximises q·p - |p|²/2. Each of
// the queries side by side goes through the same operations in the same order,
// so that their number changes nothing.
template <class Floats, class Ints>
[[gnu::always_inline]] inline void FindNearestInLanes(
    const Cloud& queries, const PackedCloud& points,
    std::vector<int>& nearest) {
  constexpr int lanes = sizeof(Floats) / sizeof(float);
  const int num_queries = static_cast<int>(queries.cols());
  const int num_points = static_cast<int>(points.cols());
  for (int begin = 0; begin < num_queries; begin += lanes) {
    const int count = std::min(lanes, num_queries - begin);
    Floats q[6] = {};
    for (int k = 0; k < 6; ++k) {
      for (int i = 0; i < count; ++i) q[k][i] = queries(k, begin + i);
    }
    Floats best = Floats{} - std::numeric_limits<float>::infinity();
    Ints index = {};
    const float* p = points.data();
    for (int j = 0; j < num_points; ++j, p += 7) {
      const Floats score = q[0] * p[0] + q[1] * p[1] + q[2] * p[2] +
                           q[3] * p[3] + q[4] * p[4] + q[5] * p[5] - p[6];
      const Ints is_nearer = score > best;
      index = is_nearer ? Ints{} + j : index;
      best = is_nearer ? score : best;
    }
    for (int i = 0; i < count; ++i) nearest[begin + i] = index[i];
  }
}

#ifdef __x86_64__
[[gnu::target("avx2")]] void FindNearestWithAvx2(const Cloud& queries,
                                                 const PackedCloud& points,
                                                 std::vector<int>& nearest) {
  FindNearestInLanes<Floats8, Ints8>(queries, points, nearest);
}
#endif

std::vector<int> FindNearest(const Cloud& queries, const Cloud& points) {
  PackedCloud packed(7, points.cols());
  packed.topRows<6>() = points;
  packed.row(6) = 0.5f * points.colwise().squaredNorm();
  std::vector<int> nearest(queries.cols());
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2")) {
    FindNearestWithAvx2(queries, packed, nearest);
    return nearest;
  }
#endif
  FindNearestInLanes<Floats4, Ints4>(queries, packed, nearest);
  return nearest;
}

std::vector<double> CalcSquaredDistances(const Cloud& queries,
                                         const Cloud& points,
                                         const std::vector<int>& nearest) {
  std::vector<double> squared(nearest.size());
  for (int i = 0; i < queries.cols(); ++i) {
    squared[i] = (queries.col(i) - points.col(nearest[i])).squaredNorm();
  }
  return squared;
}

double CalcCappedMean(const std::vector<double>& squared) {
  double sum = 0.0;
  for (const double value : squared) sum += std::min(value, kResidualCap);
  return sum / static_cast<double>(squared.size());
}

}  // namespace

Eigen::Vector3d AffineMap::MapNormal(const Eigen::Vector3d& nhat_E) const {
  // The cofactor matrix: det · inverse transpose, without a division.
  Eigen::Matrix3d cofactor;
  cofactor.col(0) = linear.col(1).cross(linear.col(2));
  cofactor.col(1) = linear.col(2).cross(linear.col(0));
  cofactor.col(2) = linear.col(0).cross(linear.col(1));
  return (cofactor * nhat_E).normalized();
}

NormalizedSamples::NormalizedSamples(const SurfaceSamples& samples,
                                     double fixed_radius)
    : points(3, samples.size()), normals(3, samples.size()) {
  GRASPDB_EXPECTS(samples.size() > 0);
  for (int i = 0; i < samples.size(); ++i) {
    points.col(i) = samples.points[i];
    normals.col(i) = samples.normals[i];
  }
  centre = points.rowwise().mean();
  points.colwise() -= centre;
  radius = fixed_radius > 0.0
               ? fixed_radius
               : std::sqrt(points.colwise().squaredNorm().mean());
  GRASPDB_EXPECTS(radius > 0.0);
  points /= radius;
}

SampleMatches MatchSamples(const NormalizedSamples& samples_E,
                           const NormalizedSamples& samples_N,
                           const AffineMap& map, double normal_weight) {
  Eigen::Matrix3Xd normals(3, samples_E.normals.cols());
  for (int i = 0; i < normals.cols(); ++i) {
    normals.col(i) = map.MapNormal(samples_E.normals.col(i));
  }
  const Eigen::Matrix3Xd points =
      (map.linear * samples_E.points).colwise() + map.translation;
  const Cloud cloud_E = MakeCloud(points, normals, normal_weight);
  const Cloud cloud_N =
      MakeCloud(samples_N.points, samples_N.normals, normal_weight);
  SampleMatches matches;
  matches.N_of_E = FindNearest(cloud_E, cloud_N);
  matches.E_of_N = FindNearest(cloud_N, cloud_E);
  matches.squared_E = CalcSquaredDistances(cloud_E, cloud_N, matches.N_of_E);
  matches.squared_N = CalcSquaredDistances(cloud_N, cloud_E, matches.E_of_N);
  return matches;
}

double CalcResidual(const SampleMatches& matches, bool partial_N) {
  if (partial_N) return CalcCappedMean(matches.squared_N);
  return 0.5 * (CalcCappedMean(matches.squared_E) +
                CalcCappedMean(matches.squared_N));
}

double CalcRobustWeight(double squared_distance) {
  const double ratio = 1.0 + squared_distance / kRobustWidth;
  return 1.0 / (ratio * ratio);
}

}  // namespace graspdb
