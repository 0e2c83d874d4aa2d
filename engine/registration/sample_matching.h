#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/geometry/surface_samples.h"

namespace graspdb {

/** An affine map from frame E to frame N: p_N = linear · p_E + translation. */
struct AffineMap {
  Eigen::Matrix3d linear{Eigen::Matrix3d::Identity()};
  Eigen::Vector3d translation{Eigen::Vector3d::Zero()};  ///< Metres.

  Eigen::Vector3d operator*(const Eigen::Vector3d& p_E) const {
    return linear * p_E + translation;
  }
  /** A unit normal of E's surface on the mapped surface, unit.
   @pre det(linear) > 0. */
  Eigen::Vector3d MapNormal(const Eigen::Vector3d& nhat_E) const;
  /** this · other. */
  AffineMap operator*(const AffineMap& other) const {
    return {linear * other.linear, linear * other.translation + translation};
  }

  bool operator==(const AffineMap&) const = default;
};

/** Surface samples in their own frame C: centred on their mean and divided by
 their rms radius, so that no unit is left. */
struct NormalizedSamples {
  /** @pre The samples do not all coincide.
   @param radius  Used instead of the rms radius when positive, metres. */
  explicit NormalizedSamples(const SurfaceSamples& samples,
                             double radius = 0.0);

  Eigen::Matrix3Xd points;   ///< Rms radii.
  Eigen::Matrix3Xd normals;  ///< Unit.
  Eigen::Vector3d centre;    ///< The mean, in the samples' frame, metres.
  double radius{1.0};        ///< One unit of `points`, metres.
};

/** For each sample of either surface the nearest one of the other, nearest in
 six dimensions: position and normal_weight × normal. */
struct SampleMatches {
  std::vector<int> N_of_E;
  std::vector<int> E_of_N;
  std::vector<double> squared_E;  ///< 6-D squared distances of N_of_E …
  std::vector<double> squared_N;  ///< … and of E_of_N, squared rms radii of N.
};

/** Matches samples of E, mapped by `map`, with those of N. */
SampleMatches MatchSamples(const NormalizedSamples& samples_E,
                           const NormalizedSamples& samples_N,
                           const AffineMap& map, double normal_weight);

/** The mean of both directions' squared distances, each capped, so that parts
 without a counterpart count but do not dominate: squared rms radii of N.
 @param partial_N  Only from N to E. */
double CalcResidual(const SampleMatches& matches, bool partial_N = false);

/** The weight of a match at this squared distance: 1 at zero, falling smoothly
 (Geman and McClure), so that what has no counterpart does not pull. */
double CalcRobustWeight(double squared_distance);

}  // namespace graspdb
