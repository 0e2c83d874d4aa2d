#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/surface_index.h"
#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** Signed distances to a closed surface on a regular grid, for cheap bounds:
 trilinear inside the grid's box, a lower bound outside it. Immutable, shared by
 threads. */
class DistanceField {
 public:
  /** @param cells  Cells along the longest side of the mesh's box.
   @param margin  The grid reaches this far beyond the box, m.
   @pre mesh_M is the mesh that index_M was made of, closed. */
  DistanceField(const TriangleMesh& mesh_M, const SurfaceIndex& index_M,
                int cells, double margin);

  /** The signed distance at p, m; negative inside. Within the grid it differs
   from the true one by at most max_error(); outside the grid the true one is
   no smaller than this, less max_error(). */
  double Calc(const Eigen::Vector3d& p_M) const;

  /** A proven bound of the interpolation's error: distance has Lipschitz
   constant one, so the error is at most the weighted mean distance to the
   cell's corners, √3/2 cells at its centre. */
  double max_error() const { return max_error_; }

  double cell_size() const { return cell_; }

 private:
  std::array<int, 3> count_{};
  Eigen::Vector3d origin_;
  Eigen::Vector3d top_;
  double margin_{0.0};
  double cell_{0.0};
  double inverse_cell_{0.0};
  double max_error_{0.0};
  std::vector<float> values_;
};

}  // namespace graspdb
