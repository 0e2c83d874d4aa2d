#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/points4.h"
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
   larger than this, plus max_error(), either. Where this is below -max_error(),
   p is inside. */
  double Calc(const Eigen::Vector3d& p_M) const;

  /** The slope of Calc() at p: within a cell of the surface straight out of the
   solid. Not normalised; zero outside the grid. */
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

  /** What its values take. */
  int64_t bytes() const {
    return static_cast<int64_t>(values_.size() * sizeof(float));
  }

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
 body's frame L, one or four at a time. Single precision: what that errs is
 within max_error(). Refers to the field. */
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
      x_[k] = static_cast<float>(turn(k, 0)) + Floats4{};
      y_[k] = static_cast<float>(turn(k, 1)) + Floats4{};
      z_[k] = static_cast<float>(turn(k, 2)) + Floats4{};
      shift_[k] = static_cast<float>(shift[k]) + Floats4{};
      last_[k] = static_cast<float>(field.last_[k]) + Floats4{};
      last_cell_[k] = field.count_[k] - 2 + Ints4{};
    }
  }

  double operator()(const Eigen::Vector3d& p_L) const {
    Points4 points;
    points.Set(0, p_L);
    return (*this)(points)[0];
  }

  Floats4 operator()(const Points4& p_L) const {
    // In cells from the grid's origin.
    const auto transform = [&p_L, this](int k) {
      return x_[k] * p_L.x + y_[k] * p_L.y + z_[k] * p_L.z + shift_[k];
    };
    const Floats4 u = transform(0);
    const Floats4 v = transform(1);
    const Floats4 w = transform(2);
    const Floats4 zero{};
    const auto clamp = [&zero, this](const Floats4& value, int k) {
      const Floats4 positive = value > zero ? value : zero;
      const Floats4& last = last_[k];
      return positive < last ? positive : last;
    };
    const Floats4 u_inside = clamp(u, 0);
    const Floats4 v_inside = clamp(v, 1);
    const Floats4 w_inside = clamp(w, 2);
    const Floats4 value = Interpolate(u_inside, v_inside, w_inside);
    // Beyond the grid, both are proven: the mesh ends margin_ before it does,
    // and distance has Lipschitz constant one.
    const Floats4 du = u - u_inside;
    const Floats4 dv = v - v_inside;
    const Floats4 dw = w - w_inside;
    const Floats4 beyond_squared = du * du + dv * dv + dw * dw;
    Floats4 result = value;
    for (int lane = 0; lane < 4; ++lane) {
      if (beyond_squared[lane] == 0.0F) continue;
      const float beyond = cell_ * std::sqrt(beyond_squared[lane]);
      result[lane] = std::max(beyond + margin_, value[lane] - beyond);
    }
    return result;
  }

 private:
  using Floats2 = float __attribute__((vector_size(8)));

  // The values of four nodes and of those next to them along x.
  static std::pair<Floats4, Floats4> LoadRows(const float* values,
                                              const Ints4& index) {
    const auto load = [values, &index](int lane) {
      Floats2 pair;
      std::memcpy(&pair, values + index[lane], sizeof(pair));
      return pair;
    };
    const Floats4 ab = __builtin_shufflevector(load(0), load(1), 0, 1, 2, 3);
    const Floats4 cd = __builtin_shufflevector(load(2), load(3), 0, 1, 2, 3);
    return {__builtin_shufflevector(ab, cd, 0, 2, 4, 6),
            __builtin_shufflevector(ab, cd, 1, 3, 5, 7)};
  }

  // Within the grid.
  Floats4 Interpolate(const Floats4& u, const Floats4& v,
                      const Floats4& w) const {
    const auto find_cell = [this](const Floats4& value, int k) {
      const Ints4 cell = __builtin_convertvector(value, Ints4);
      const Ints4& last = last_cell_[k];
      return cell < last ? cell : last;
    };
    const Ints4 ix = find_cell(u, 0);
    const Ints4 iy = find_cell(v, 1);
    const Ints4 iz = find_cell(w, 2);
    const Floats4 tx = u - __builtin_convertvector(ix, Floats4);
    const Floats4 ty = v - __builtin_convertvector(iy, Floats4);
    const Floats4 tz = w - __builtin_convertvector(iz, Floats4);
    const Ints4 index = ix + stride_y_ * iy + stride_z_ * iz;
    const auto along_x = [&](int offset) {
      const auto [here, next] = LoadRows(values_ + offset, index);
      return here + tx * (next - here);
    };
    const Floats4 a = along_x(0);
    const Floats4 b = along_x(stride_y_);
    const Floats4 c = along_x(stride_z_);
    const Floats4 d = along_x(stride_z_ + stride_y_);
    const Floats4 low = a + ty * (b - a);
    const Floats4 high = c + ty * (d - c);
    return low + tz * (high - low);
  }

  // Columns of the body's axes, and where it stands, in cells.
  std::array<Floats4, 3> x_;
  std::array<Floats4, 3> y_;
  std::array<Floats4, 3> z_;
  std::array<Floats4, 3> shift_;
  std::array<Floats4, 3> last_;
  std::array<Ints4, 3> last_cell_;
  const float* values_;
  int stride_y_;
  int stride_z_;
  float cell_;
  float margin_;
};

}  // namespace graspdb
