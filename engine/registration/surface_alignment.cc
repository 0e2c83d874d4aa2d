#include "engine/registration/surface_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "engine/base/contract.h"
#include "engine/base/parallel.h"

namespace graspdb {
namespace {

// Starts are judged on few samples, the best of them tried on more, and only
// the winner is polished on all.
constexpr int kFirstSteps = 5;
constexpr int kCoarseSteps = 4;
constexpr int kCoarseShare = 3;  // One start in so many passes the first steps.
constexpr int kMediumSamples = 500;
constexpr int kMediumSteps = 12;
constexpr int kFinalSteps = 6;
constexpr int kLocalSteps = 20;

constexpr double kStartTurn = 40.0 * std::numbers::pi / 180.0;
constexpr double kMinDifference = 15.0 * std::numbers::pi / 180.0;
constexpr double kMinStretch = 0.55;
constexpr double kMaxStretch = 1.8;
// Holds back the directions that the matches leave open, as a share of the
// matches' weight.
constexpr double kDamping = 0.02;
// Of the unstretched residual in the dissimilarity.
constexpr double kUnstretchedShare = 0.3;

// The rotation of least squares for a cross-covariance (Umeyama 1991).
Eigen::Matrix3d CalcNearestRotation(const Eigen::Matrix3d& covariance) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(
      covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign =
      svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0 ? -1.0
                                                                      : 1.0;
  return svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() *
         svd.matrixV().transpose();
}

// Brings the singular values within their bounds; keeps the directions.
Eigen::Matrix3d ClampStretch(const Eigen::Matrix3d& linear) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
      linear.transpose() * linear);
  const Eigen::Array3d stretch = solver.eigenvalues().array().max(1e-12).sqrt();
  const Eigen::Array3d change =
      stretch.max(kMinStretch).min(kMaxStretch) / stretch;
  return linear * solver.eigenvectors() * change.matrix().asDiagonal() *
         solver.eigenvectors().transpose();
}

// Calls add(i, j, weight) for the matches of both directions, or of one.
template <class F>
void ForEachMatch(const SampleMatches& matches, bool partial_N, F&& add) {
  for (size_t i = 0; !partial_N && i < matches.N_of_E.size(); ++i) {
    add(static_cast<int>(i), matches.N_of_E[i],
        CalcRobustWeight(matches.squared_E[i]));
  }
  for (size_t j = 0; j < matches.E_of_N.size(); ++j) {
    add(matches.E_of_N[j], static_cast<int>(j),
        CalcRobustWeight(matches.squared_N[j]));
  }
}

// The rotation and translation of least squares, positions and normals.
AffineMap FitRigid(const NormalizedSamples& E, const NormalizedSamples& N,
                   const SampleMatches& matches, double normal_weight,
                   bool partial_N) {
  double weight = 0.0;
  Eigen::Vector3d sum_E = Eigen::Vector3d::Zero();
  Eigen::Vector3d sum_N = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d normal_products = Eigen::Matrix3d::Zero();
  ForEachMatch(matches, partial_N, [&](int i, int j, double w) {
    weight += w;
    sum_E += w * E.points.col(i);
    sum_N += w * N.points.col(j);
    products += w * N.points.col(j) * E.points.col(i).transpose();
    normal_products += w * N.normals.col(j) * E.normals.col(i).transpose();
  });
  const Eigen::Matrix3d rotation =
      CalcNearestRotation(products - sum_N * sum_E.transpose() / weight +
                          normal_weight * normal_weight * normal_products);
  return {rotation, (sum_N - rotation * sum_E) / weight};
}

// The affine map of least squares, positions only, near the previous one.
AffineMap FitAffine(const NormalizedSamples& E, const NormalizedSamples& N,
                    const SampleMatches& matches, const AffineMap& previous,
                    bool partial_N) {
  // p_N ≈ [linear translation] (p_E, 1): normal equations of all three rows.
  Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> right = Eigen::Matrix<double, 4, 3>::Zero();
  ForEachMatch(matches, partial_N, [&](int i, int j, double w) {
    const Eigen::Vector4d p = E.points.col(i).homogeneous();
    gram += w * p * p.transpose();
    right += w * p * N.points.col(j).transpose();
  });
  const double damping = kDamping * gram(3, 3);
  gram.diagonal().array() += damping;
  right.topRows<3>() += damping * previous.linear.transpose();
  right.row(3) += damping * previous.translation.transpose();
  const Eigen::Matrix<double, 3, 4> solution =
      gram.ldlt().solve(right).transpose();
  return {ClampStretch(solution.leftCols<3>()), solution.col(3)};
}

Eigen::Matrix3d CalcPrincipalAxes(const Eigen::Matrix3Xd& points) {
  Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(
                             points * points.transpose())
                             .eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) = -axes.col(0);
  return axes;
}

std::vector<Eigen::Matrix3d> MakeStartRotations(const NormalizedSamples& E,
                                                const NormalizedSamples& N) {
  std::vector<Eigen::Matrix3d> turns{Eigen::Matrix3d::Identity()};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double angle : {-kStartTurn, kStartTurn}) {
      turns.push_back(Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis))
                          .toRotationMatrix());
    }
  }
  const Eigen::Matrix3d axes_E = CalcPrincipalAxes(E.points);
  const Eigen::Matrix3d axes_N = CalcPrincipalAxes(N.points);
  std::vector<Eigen::Matrix3d> rotations;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d match = Eigen::Matrix3d::Zero();
      for (int k = 0; k < 3; ++k) {
        match(k, order[k]) = signs >> k & 1 ? -1.0 : 1.0;
      }
      if (match.determinant() < 0.0) continue;
      for (const Eigen::Matrix3d& turn : turns) {
        rotations.push_back(axes_N * turn * match * axes_E.transpose());
      }
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return rotations;
}

// Every k-th sample.
NormalizedSamples Thin(const NormalizedSamples& all, int count) {
  const int total = static_cast<int>(all.points.cols());
  if (count >= total) return all;
  NormalizedSamples thinned = all;
  thinned.points.resize(3, count);
  thinned.normals.resize(3, count);
  for (int i = 0; i < count; ++i) {
    const int source = static_cast<int>((i + 0.5) * total / count);
    thinned.points.col(i) = all.points.col(source);
    thinned.normals.col(i) = all.normals.col(source);
  }
  return thinned;
}

// A map between normalised samples and how well it fits.
struct Candidate {
  AffineMap map;
  double residual{0.0};
};

void SortByResidual(std::vector<Candidate>& candidates) {
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const auto& a, const auto& b) { return a.residual < b.residual; });
}

// Aligns one pair of sample sets.
class Aligner {
 public:
  Aligner(const SurfaceSamples& samples_E, const SurfaceSamples& samples_N,
          const AlignmentOptions& options)
      : N_(samples_N),
        // A rigid alignment measures both in the same unit.
        E_(samples_E, options.scale ? 0.0 : N_.radius),
        options_(options) {}

  Candidate FindBest() const {
    std::vector<Candidate> candidates = FindStarts();
    const NormalizedSamples E = Thin(E_, kMediumSamples);
    const NormalizedSamples N = Thin(N_, kMediumSamples);
    IterateAll(E, N, kMediumSteps, candidates);
    if (!options_.scale) {
      for (Candidate& c : candidates) c.residual = CalcDeviation(E, N, c.map);
    }
    SortByResidual(candidates);
    return Polish(candidates.front().map);
  }

  // From nearby: most of the way on few samples.
  Candidate Refine(const AffineMap& map) const {
    return Polish(Iterate(Thin(E_, kMediumSamples), Thin(N_, kMediumSamples),
                          map, kLocalSteps)
                      .map);
  }

  Candidate Polish(const AffineMap& map) const {
    Candidate result = Iterate(E_, N_, map, kFinalSteps);
    result.residual =
        CalcResidual(Match(E_, N_, result.map), options_.partial_N);
    return result;
  }

  AffineMap FromAlignment(const SurfaceAlignment& a) const {
    const double scale = options_.scale ? a.scale * E_.radius / N_.radius : 1.0;
    return {scale * a.X_NE.rotation, (a * E_.centre - N_.centre) / N_.radius};
  }

  SurfaceAlignment ToAlignment(const Candidate& best) const {
    SurfaceAlignment result;
    result.residual = best.residual;
    result.map_NE.linear = N_.radius / E_.radius * best.map.linear;
    result.map_NE.translation = N_.centre + N_.radius * best.map.translation -
                                result.map_NE.linear * E_.centre;
    // The nearest similarity over E's samples, whose mean is E_.centre.
    const Eigen::Matrix3d spread = E_.points * E_.points.transpose();
    const Eigen::Matrix3d covariance = result.map_NE.linear * spread;
    result.X_NE.rotation = CalcNearestRotation(covariance);
    if (options_.scale) {
      result.scale = (result.X_NE.rotation.transpose() * covariance).trace() /
                     spread.trace();
    }
    result.X_NE.translation = result.map_NE * E_.centre -
                              result.X_NE.rotation * (result.scale * E_.centre);
    result.unstretched_residual =
        CalcResidual(Match(E_, N_, FromAlignment(result)), options_.partial_N);
    return result;
  }

  double CalcDeviation(const NormalizedSamples& E, const NormalizedSamples& N,
                       const AffineMap& map) const {
    const SampleMatches matches = Match(E, N, map);
    const double lambda = options_.normal_weight * options_.normal_weight;
    double sum = 0.0;
    for (int i = 0; i < E.points.cols(); ++i) {
      const int j = matches.N_of_E[i];
      const double cosine =
          N.normals.col(j).dot(map.MapNormal(E.normals.col(i)));
      const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
      sum += (map * E.points.col(i) - N.points.col(j)).squaredNorm() +
             lambda * angle * angle;
    }
    return sum;
  }

  const NormalizedSamples& E() const { return E_; }
  const NormalizedSamples& N() const { return N_; }

 private:
  SampleMatches Match(const NormalizedSamples& E, const NormalizedSamples& N,
                      const AffineMap& map) const {
    return MatchSamples(E, N, map, options_.normal_weight);
  }

  // Matches and fits in turn. The residual is the one before the last fit.
  Candidate Iterate(const NormalizedSamples& E, const NormalizedSamples& N,
                    AffineMap map, int steps) const {
    double residual = 0.0;
    for (int step = 0; step < steps; ++step) {
      const SampleMatches matches = Match(E, N, map);
      residual = CalcResidual(matches, options_.partial_N);
      const AffineMap next =
          options_.scale ? FitAffine(E, N, matches, map, options_.partial_N)
                         : FitRigid(E, N, matches, options_.normal_weight,
                                    options_.partial_N);
      const double change = (next.linear - map.linear).norm() +
                            (next.translation - map.translation).norm();
      map = next;
      if (change < 1e-6) break;
    }
    return {map, residual};
  }

  void IterateAll(const NormalizedSamples& E, const NormalizedSamples& N,
                  int steps, std::vector<Candidate>& candidates) const {
    ParallelFor(static_cast<int>(candidates.size()), [&](int i) {
      Candidate& candidate = candidates[static_cast<size_t>(i)];
      candidate = Iterate(E, N, candidate.map, steps);
    });
  }

  // The best starts after a few steps on few samples, all different.
  std::vector<Candidate> FindStarts() const {
    const NormalizedSamples E = Thin(E_, options_.coarse_samples);
    const NormalizedSamples N = Thin(N_, options_.coarse_samples);
    std::vector<Candidate> all;
    for (const Eigen::Matrix3d& rotation : options_.start_rotations.empty()
                                               ? MakeStartRotations(E_, N_)
                                               : options_.start_rotations) {
      all.push_back({{rotation, Eigen::Vector3d::Zero()}, 0.0});
    }
    IterateAll(E, N, kFirstSteps, all);
    SortByResidual(all);
    all.resize((all.size() + kCoarseShare - 1) / kCoarseShare);
    IterateAll(E, N, kCoarseSteps, all);
    SortByResidual(all);
    std::vector<Candidate> chosen;
    for (const Candidate& candidate : all) {
      if (static_cast<int>(chosen.size()) == options_.refined_starts) break;
      const Eigen::Matrix3d rotation =
          CalcNearestRotation(candidate.map.linear);
      if (std::all_of(chosen.begin(), chosen.end(), [&](const auto& other) {
            return CalcRotationAngle(rotation.transpose() *
                                     CalcNearestRotation(other.map.linear)) >
                   kMinDifference;
          })) {
        chosen.push_back(candidate);
      }
    }
    return chosen;
  }

  NormalizedSamples N_;
  NormalizedSamples E_;
  const AlignmentOptions& options_;
};

constexpr int kMinSamples = 4;

}  // namespace

SurfaceAlignment AlignSurfaces(const SurfaceSamples& samples_E,
                               const SurfaceSamples& samples_N,
                               const AlignmentOptions& options) {
  GRASPDB_EXPECTS(std::min(samples_E.size(), samples_N.size()) >= kMinSamples);
  GRASPDB_EXPECTS(options.refined_starts > 0 && options.coarse_samples > 0);
  const Aligner aligner(samples_E, samples_N, options);
  return aligner.ToAlignment(aligner.FindBest());
}

SurfaceAlignment RefineAlignment(const SurfaceSamples& samples_E,
                                 const SurfaceSamples& samples_N,
                                 const SurfaceAlignment& initial,
                                 const AlignmentOptions& options) {
  GRASPDB_EXPECTS(std::min(samples_E.size(), samples_N.size()) >= kMinSamples);
  const Aligner aligner(samples_E, samples_N, options);
  return aligner.ToAlignment(aligner.Refine(aligner.FromAlignment(initial)));
}

double CalcDissimilarity(const SurfaceAlignment& alignment) {
  return alignment.residual +
         kUnstretchedShare * alignment.unstretched_residual;
}

double CalcSimilarity(const SurfaceAlignment& alignment, double half) {
  GRASPDB_EXPECTS(half > 0.0);
  return std::exp2(-CalcDissimilarity(alignment) / half);
}

double CalcAlignmentDeviation(const SurfaceSamples& samples_E,
                              const SurfaceSamples& samples_N,
                              const SurfaceAlignment& alignment,
                              double normal_weight) {
  AlignmentOptions options;
  options.scale = true;
  options.normal_weight = normal_weight;
  const Aligner aligner(samples_E, samples_N, options);
  return aligner.CalcDeviation(aligner.E(), aligner.N(),
                               aligner.FromAlignment(alignment));
}

}  // namespace graspdb
