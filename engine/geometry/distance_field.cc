#include "engine/geometry/distance_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/contract.h"
#include "engine/base/parallel.h"

namespace graspdb {
namespace {

// Every so many nodes are computed first; the rest only near the surface.
constexpr int kCoarse = 2;
// Where single precision puts a point among some hundred cells, in cells.
constexpr double kRounding = 1e-4;

// @param reach  No point of the surface farther than this matters.
float CalcSigned(const SurfaceIndex& index_M, const Eigen::Vector3d& p_M,
                 double reach) {
  const ClosestPoint c = *index_M.FindClosest(p_M, reach);
  const bool outside = (p_M - c.p_M).dot(c.pseudonormal) >= 0.0;
  return static_cast<float>(outside ? c.distance : -c.distance);
}

}  // namespace

DistanceField::DistanceField(const TriangleMesh& mesh_M,
                             const SurfaceIndex& index_M, int cells,
                             double margin)
    : margin_(margin) {
  GRASPDB_EXPECTS(cells > 0 && margin >= 0.0 && mesh_M.num_triangles() > 0);
  const Eigen::Vector3d size = mesh_M.box_max() - mesh_M.box_min() +
                               Eigen::Vector3d::Constant(2.0 * margin);
  cell_ = size.maxCoeff() / cells;
  inverse_cell_ = 1.0 / cell_;
  max_error_ = (0.5 * std::sqrt(3.0) + kRounding) * cell_;
  origin_ = mesh_M.box_min() - Eigen::Vector3d::Constant(margin);
  for (int k = 0; k < 3; ++k) {
    count_[k] = kCoarse * static_cast<int>(
                              std::ceil(size[k] * inverse_cell_ / kCoarse)) +
                1;
    last_[k] = count_[k] - 1;
  }
  stride_y_ = static_cast<size_t>(count_[0]);
  stride_z_ = stride_y_ * count_[1];
  values_.resize(stride_z_ * count_[2]);
  FillCoarse(index_M);
  FillRest(index_M);
}

void DistanceField::FillCoarse(const SurfaceIndex& index_M) {
  ParallelFor((count_[2] + 1) / kCoarse, [&](int slice) {
    const int iz = kCoarse * slice;
    for (int iy = 0; iy < count_[1]; iy += kCoarse) {
      // The neighbour's value bounds the search.
      double reach = std::numeric_limits<double>::infinity();
      for (int ix = 0; ix < count_[0]; ix += kCoarse) {
        at(ix, iy, iz) = CalcSigned(index_M, CalcNode(ix, iy, iz), reach);
        reach = std::abs(at(ix, iy, iz)) + 1.001 * kCoarse * cell_;
      }
    }
  });
}

void DistanceField::FillRest(const SurfaceIndex& index_M) {
  // A point one cell from the surface has corners of its cell up to here.
  const double reach = (1.0 + std::sqrt(3.0)) * cell_;
  ParallelFor(count_[2], [&](int iz) {
    for (int iy = 0; iy < count_[1]; ++iy) {
      for (int ix = 0; ix < count_[0]; ++ix) {
        const std::array<int, 3> odd{ix % kCoarse, iy % kCoarse, iz % kCoarse};
        if (odd == std::array<int, 3>{}) continue;
        // What the coarse nodes around it, all as far away, leave possible.
        const double apart =
            cell_ * std::sqrt(static_cast<double>(odd[0] + odd[1] + odd[2]));
        double most = -std::numeric_limits<double>::infinity();
        double least = std::numeric_limits<double>::infinity();
        for (const int dz : {-odd[2], odd[2]}) {
          for (const int dy : {-odd[1], odd[1]}) {
            for (const int dx : {-odd[0], odd[0]}) {
              const double near = at(ix + dx, iy + dy, iz + dz);
              most = std::max(most, near);
              least = std::min(least, near);
            }
          }
        }
        const double low = most - apart;
        const double high = least + apart;
        at(ix, iy, iz) = low > reach || high < -reach
                             ? static_cast<float>(low)
                             : CalcSigned(index_M, CalcNode(ix, iy, iz),
                                          1.001 * std::max(-low, high) + 1e-9);
      }
    }
  });
}

double DistanceField::Calc(const Eigen::Vector3d& p_M) const {
  return PosedField(*this, RigidTransform::Identity())(p_M);
}

}  // namespace graspdb
