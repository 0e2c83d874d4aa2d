#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/surface_index.h"
#include "engine/geometry/surface_samples.h"
#include "engine/math/kd_tree.h"
#include "engine/parameters/transfer_parameters.h"

namespace graspdb {

/** The correspondence between an example part E and a novel part N, built once
 from their surface samples and queried for many contact points.
 Lengths are metres; normals are unit length and point out of the object.
 @paper{Sec. V-A} */
class ContactMap {
 public:
  /** @param samples_E  The paper's A: points and normals expressed in frame E.
   @param samples_N  The paper's B: points and normals expressed in frame N.
   @param moved_E  A in frame N: under the paper's (R*, T*), or a refinement.
   @param index_N  The novel part's surface, to which images are projected;
     outlives the map.
   @param index_E  The example part's surface; outlives the map.
   @pre Neither sample set is empty; moved_E has as many as samples_E. */
  ContactMap(SurfaceSamples samples_E, SurfaceSamples samples_N,
             const SurfaceSamples& moved_E, const SurfaceIndex& index_E,
             const SurfaceIndex& index_N, const MappingParameters& parameters);

  /** F(a) for each a of A: the nearest b whose normal is within δ of R* n_a;
   -1 when there is none. @paper{Eq. (2)} */
  const std::vector<int>& forward() const { return forward_; }

  /** F⁻¹(b) for each b of B: the a whose image under (R*, T*) is nearest and
   whose turned normal is within δ of n_b; -1 when there is none.
   @paper{Eq. (3)} */
  const std::vector<int>& backward() const { return backward_; }

  /** Maps the point X of the example's surface, with the normal there, to the
   novel one: the mean of the images of its nearest samples, projected onto the
   surface. Nothing when no neighbour of X has an image. @paper{Eq. (4)} */
  std::optional<Eigen::Vector3d> MapForward(
      const Eigen::Vector3d& p_EX, const Eigen::Vector3d& nhat_E) const;

  /** The same, back. @paper{Eq. (5)} */
  std::optional<Eigen::Vector3d> MapBackward(
      const Eigen::Vector3d& p_NY, const Eigen::Vector3d& nhat_N) const;

  /** |x − F⁻¹(F(x))|, metres; nothing when either map is undefined there.
   @paper{Sec. V-A, consistency check} */
  std::optional<double> CalcRoundTripError(const Eigen::Vector3d& p_EX,
                                           const Eigen::Vector3d& nhat_E) const;

  /** MapForward() where the round trip's error is below γ times the example
   part's diagonal; nothing elsewhere. */
  std::optional<Eigen::Vector3d> MapConsistently(
      const Eigen::Vector3d& p_EX, const Eigen::Vector3d& nhat_E) const;

  /** The share of the example's samples that map consistently. */
  double CalcMappedShare() const;

 private:
  SurfaceSamples samples_E_;
  SurfaceSamples samples_N_;
  const SurfaceIndex* index_E_;
  const SurfaceIndex* index_N_;
  MappingParameters parameters_;
  double max_error_{0.0};  // γ, metres.
  KdTree tree_E_;
  KdTree tree_N_;
  std::vector<int> forward_;
  std::vector<int> backward_;
};

}  // namespace graspdb
