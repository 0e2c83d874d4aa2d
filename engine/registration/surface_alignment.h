#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/geometry/surface_samples.h"
#include "engine/math/rigid_transform.h"
#include "engine/registration/sample_matching.h"

namespace graspdb {

/** How an example surface E lies on a novel one N: E is scaled about its
 origin, then posed, p_N = X_NE · (scale · p_E). */
struct SurfaceAlignment {
  RigidTransform X_NE;
  double scale{1.0};
  /** The affine map that (X_NE, scale) is the nearest similarity to; tells
   which point lies where, as X_NE tells how a hand moves. For a rigid alignment
   the same as X_NE. Metres. */
  AffineMap map_NE;
  /** Mean of both directions' capped squared 6-D distances between nearest
   samples under map_NE, squared rms radii of N: 0 for copies, small within a
   category, large for foreign objects. */
  double residual{0.0};
  /** The same under (X_NE, scale) alone: what the stretch hides shows here. */
  double unstretched_residual{0.0};

  Eigen::Vector3d operator*(const Eigen::Vector3d& p_E) const {
    return X_NE * Eigen::Vector3d(scale * p_E);
  }
  bool operator==(const SurfaceAlignment&) const = default;
};

struct AlignmentOptions {
  /** E may be stretched and sheared to find where its points lie, each
   stretch within 0.55 to 1.8 of the ratio of the rms radii, and X_NE comes with
   a scale; else all is rigid, as in the paper. */
  bool scale{true};
  double normal_weight{0.5};  ///< Of normals beside positions in rms radii.
  int coarse_samples{150};    ///< Used to judge the starts.
  int refined_starts{8};      ///< Best different starts that are refined.
  /** N shows a part of its surface only: of the matches, those from E to N
   count for nothing. */
  bool partial_N{false};
  /** Rotations R_NE to start from; when empty, the 24 proper matches of the
   principal axes, each also turned by ±40° about each axis. */
  std::vector<Eigen::Matrix3d> start_rotations{};
};

/** The rigid alignment of Sec. V-A, made global and robust: many starts,
 nearest neighbours in both directions by position and normal together, robust
 weights. Among the refined starts the one of the least residual wins; for a
 rigid alignment that of the least CalcAlignmentDeviation(), as in the paper.
 Deterministic. Does not depend on the pose of either surface, nor, with scale,
 on its unit.
 @param samples_E, samples_N  In face order, as the samplers give them, so that
   every k-th one is a fair subset. Metres.
 @pre Both have at least 4 samples. @paper{Sec. V-A} */
SurfaceAlignment AlignSurfaces(const SurfaceSamples& samples_E,
                               const SurfaceSamples& samples_N,
                               const AlignmentOptions& options);

/** The same, but local: only from `initial` (its X_NE and scale). With it the
 parts of two objects are aligned from where the whole objects' alignment has
 put them, so that a body of revolution keeps the rotation that its handle
 fixes.
 @param options  Its start_rotations and refined_starts do not matter. */
SurfaceAlignment RefineAlignment(const SurfaceSamples& samples_E,
                                 const SurfaceSamples& samples_N,
                                 const SurfaceAlignment& initial,
                                 const AlignmentOptions& options);

/** How unlike the two surfaces are, squared rms radii: the residual and a share
 of what it needs the stretch for, so that a knife stretched into a hammer is
 less of a hammer than a mallet is. */
double CalcDissimilarity(const SurfaceAlignment& alignment);

/** 1 for copies, one half at the dissimilarity `half`, towards 0 beyond.
 @pre half > 0. */
double CalcSimilarity(const SurfaceAlignment& alignment, double half);

/** The sum that the rigid alignment minimises,
 Σ_a |R a + T - b_a|² / r² + λ arccos²(n_b · R n_a),
 where b_a is a's nearest sample in position and normal together, r the rms
 radius of N and λ = normal_weight². The paper leaves r and λ out, which adds
 square metres to square radians. @paper{Sec. V-A, arg min} */
double CalcAlignmentDeviation(const SurfaceSamples& samples_E,
                              const SurfaceSamples& samples_N,
                              const SurfaceAlignment& alignment,
                              double normal_weight);

}  // namespace graspdb
