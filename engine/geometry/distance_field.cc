#include "engine/geometry/distance_field.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "engine/base/contract.h"

namespace graspdb {

DistanceField::DistanceField(const TriangleMesh& mesh_M,
                             const SurfaceIndex& index_M, int cells,
                             double margin)
    : margin_(margin) {
  GRASPDB_EXPECTS(cells > 0 && margin >= 0.0 && mesh_M.num_triangles() > 0);
  const Eigen::Vector3d size = mesh_M.box_max() - mesh_M.box_min() +
                               Eigen::Vector3d::Constant(2.0 * margin);
  cell_ = size.maxCoeff() / cells;
  inverse_cell_ = 1.0 / cell_;
  max_error_ = 0.5 * std::sqrt(3.0) * cell_;
  origin_ = mesh_M.box_min() - Eigen::Vector3d::Constant(margin);
  for (int k = 0; k < 3; ++k) {
    count_[k] = static_cast<int>(std::ceil(size[k] * inverse_cell_)) + 1;
    top_[k] = origin_[k] + cell_ * (count_[k] - 1);
  }
  values_.resize(static_cast<size_t>(count_[0]) * count_[1] * count_[2]);
  tbb::parallel_for(0, count_[2], [&](int iz) {
    size_t i = static_cast<size_t>(iz) * count_[0] * count_[1];
    for (int iy = 0; iy < count_[1]; ++iy) {
      // The neighbour's value bounds the search: one is a cell away at most.
      double reach = std::numeric_limits<double>::infinity();
      for (int ix = 0; ix < count_[0]; ++ix, ++i) {
        const Eigen::Vector3d p = origin_ + cell_ * Eigen::Vector3d(ix, iy, iz);
        const ClosestPoint c = *index_M.FindClosest(p, reach);
        const bool outside = (p - c.p_M).dot(c.pseudonormal) >= 0.0;
        values_[i] = static_cast<float>(outside ? c.distance : -c.distance);
        reach = c.distance + 1.001 * cell_;
      }
    }
  });
}

double DistanceField::Calc(const Eigen::Vector3d& p_M) const {
  const Eigen::Vector3d inside = p_M.cwiseMax(origin_).cwiseMin(top_);
  const Eigen::Vector3d u = (inside - origin_) * inverse_cell_;
  std::array<int, 3> i;
  std::array<double, 3> t;
  for (int k = 0; k < 3; ++k) {
    i[k] = std::min(static_cast<int>(u[k]), count_[k] - 2);
    t[k] = u[k] - i[k];
  }
  const size_t nx = count_[0];
  const size_t nxy = nx * count_[1];
  const float* v = &values_[i[0] + nx * i[1] + nxy * i[2]];
  const auto along_x = [&t](const float* row) {
    return row[0] + t[0] * (static_cast<double>(row[1]) - row[0]);
  };
  const double y0 = along_x(v) + t[1] * (along_x(v + nx) - along_x(v));
  const double y1 =
      along_x(v + nxy) + t[1] * (along_x(v + nxy + nx) - along_x(v + nxy));
  const double value = y0 + t[2] * (y1 - y0);
  const double beyond = (p_M - inside).norm();
  if (beyond == 0.0) return value;
  // Both are proven: the mesh ends margin_ before the grid does, and distance
  // has Lipschitz constant one.
  return std::max(beyond + margin_, value - beyond);
}

}  // namespace graspdb
