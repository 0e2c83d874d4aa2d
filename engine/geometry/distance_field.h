#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/surface_index.h"
#include "engine/geometry/triangle_mesh.h"
#include "engine/math/rigid_transform.h"

namespace graspdb {

class PosedField;

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

  /** The signed distance at p, m; negative inside. The true one is nowhere
   smaller than this, less max_error(); within a cell of the surface it is no
   larger than this, plus max_error(), either. */
  double Calc(const Eigen::Vector3d& p_M) const;

  /** The slope of Calc() at p, out of the solid, not normalised; zero outside
   the grid. */
  Eigen::Vector3d CalcGradient(const Eigen::Vector3d& p_M) const {
    const Eigen::Vector3d u = (p_M - origin_) * inverse_cell_;
    if (!(u.minCoeff() >= 0.0 && (u.array() <= last_.array()).all())) {
      return Eigen::Vector3d::Zero();
    }
    const auto [v, t] = FindCell(u);
    // Of a layer: the slopes along x and y, and the value.
    const auto slope = [&t = t, y = stride_y_](const float* slice) {
      const float* row = slice + y;
      const float dx = slice[1] - slice[0];
      const float row_dx = row[1] - row[0];
      const float value = slice[0] + t[0] * dx;
      const float dy = row[0] + t[0] * row_dx - value;
      return Eigen::Vector3f(dx + t[1] * (row_dx - dx), dy, value + t[1] * dy);
    };
    const Eigen::Vector3f low = slope(v);
    const Eigen::Vector3f high = slope(v + stride_z_);
    const Eigen::Vector3d gradient(low[0] + t[2] * (high[0] - low[0]),
                                   low[1] + t[2] * (high[1] - low[1]),
                                   high[2] - low[2]);
    return inverse_cell_ * gradient;
  }

  /** A proven bound of the interpolation's error: distance has Lipschitz
   constant one, so the error is at most the weighted mean distance to the
   cell's corners, √3/2 cells at its centre; and a little for rounding. */
  double max_error() const { return max_error_; }

  double cell_size() const { return cell_; }

 private:
  friend class PosedField;

  // A cell by its corner, and where in it a point is, 0 to 1.
  struct InCell {
    const float* v;
    std::array<float, 3> t;
  };

  // At u cells from the origin, within the grid.
  InCell FindCell(const Eigen::Vector3d& u) const {
    std::array<int, 3> i;
    InCell found;
    for (int k = 0; k < 3; ++k) {
      i[k] = std::min(static_cast<int>(u[k]), count_[k] - 2);
      found.t[k] = static_cast<float>(u[k] - i[k]);
    }
    found.v = &values_[i[0] + stride_y_ * i[1] + stride_z_ * i[2]];
    return found;
  }

  void FillCoarse(const SurfaceIndex& index_M);
  void FillRest(const SurfaceIndex& index_M);
  float& at(int ix, int iy, int iz) {
    return values_[ix + stride_y_ * iy + stride_z_ * iz];
  }
  Eigen::Vector3d CalcNode(int ix, int iy, int iz) const {
    return origin_ + cell_ * Eigen::Vector3d(ix, iy, iz);
  }

  std::array<int, 3> count_{};  // Nodes; odd, so that coarse ones fit.
  Eigen::Vector3d origin_;
  Eigen::Vector3d last_;  // The last node, in cells.
  double margin_{0.0};
  double cell_{0.0};
  double inverse_cell_{0.0};
  double max_error_{0.0};
  size_t stride_y_{0};
  size_t stride_z_{0};
  std::vector<float> values_;
};

/** The field as a body sees it that stands somewhere: Calc() for points of the
 body's frame L. Single precision: what that errs is within max_error(). Refers
 to the field. */
class PosedField {
 public:
  PosedField(const DistanceField& field, const RigidTransform& X_ML)
      : values_(field.values_.data()),
        stride_y_(static_cast<int>(field.stride_y_)),
        stride_z_(static_cast<int>(field.stride_z_)),
        cell_(static_cast<float>(field.cell_)),
        margin_(static_cast<float>(field.margin_)) {
    const Eigen::Matrix3d turn = field.inverse_cell_ * X_ML.rotation;
    const Eigen::Vector3d shift =
        field.inverse_cell_ * (X_ML.translation - field.origin_);
    for (int k = 0; k < 3; ++k) {
      x_[k] = static_cast<float>(turn(k, 0));
      y_[k] = static_cast<float>(turn(k, 1));
      z_[k] = static_cast<float>(turn(k, 2));
      shift_[k] = static_cast<float>(shift[k]);
      last_[k] = static_cast<float>(field.last_[k]);
      last_cell_[k] = field.count_[k] - 2;
    }
  }

  double operator()(const Eigen::Vector3d& p_L) const {
    // In cells from the grid's origin; the fourth is always zero.
    const Eigen::Array4f u = static_cast<float>(p_L.x()) * x_ +
                             static_cast<float>(p_L.y()) * y_ +
                             static_cast<float>(p_L.z()) * z_ + shift_;
    const Eigen::Array4f inside = u.max(0.0F).min(last_);
    const float value = Interpolate(inside);
    // Beyond the grid, both are proven: the mesh ends margin_ before it does,
    // and distance has Lipschitz constant one.
    const float beyond_squared = (u - inside).square().sum();
    if (beyond_squared == 0.0F) return value;
    const float beyond = cell_ * std::sqrt(beyond_squared);
    return std::max(beyond + margin_, value - beyond);
  }

 private:
  float Interpolate(const Eigen::Array4f& u) const {
    const int ix = std::min(static_cast<int>(u[0]), last_cell_[0]);
    const int iy = std::min(static_cast<int>(u[1]), last_cell_[1]);
    const int iz = std::min(static_cast<int>(u[2]), last_cell_[2]);
    const float tx = u[0] - static_cast<float>(ix);
    const float ty = u[1] - static_cast<float>(iy);
    const float tz = u[2] - static_cast<float>(iz);
    const float* v = values_ + (ix + stride_y_ * iy + stride_z_ * iz);
    const auto along_x = [tx](const float* row) {
      return row[0] + tx * (row[1] - row[0]);
    };
    const float a = along_x(v);
    const float b = along_x(v + stride_y_);
    const float c = along_x(v + stride_z_);
    const float d = along_x(v + stride_z_ + stride_y_);
    const float low = a + ty * (b - a);
    const float high = c + ty * (d - c);
    return low + tz * (high - low);
  }

  // Columns of the body's axes, and where it stands, in cells.
  Eigen::Array4f x_{Eigen::Array4f::Zero()};
  Eigen::Array4f y_{Eigen::Array4f::Zero()};
  Eigen::Array4f z_{Eigen::Array4f::Zero()};
  Eigen::Array4f shift_{Eigen::Array4f::Zero()};
  Eigen::Array4f last_{Eigen::Array4f::Zero()};
  std::array<int, 3> last_cell_{};
  const float* values_;
  int stride_y_;
  int stride_z_;
  float cell_;
  float margin_;
};

}  // namespace graspdb
