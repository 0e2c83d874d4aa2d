#include "engine/math/orthogonal_vector.h"

#include <array>
#include <cmath>
#include <utility>

namespace graspdb {
namespace {

constexpr int kDim = 6;

}  // namespace

std::optional<Eigen::Vector<double, 6>> CalcOrthogonalByElimination(
    Eigen::Matrix<double, 5, 6> rows) {
  std::array<int, kDim> column{0, 1, 2, 3, 4, 5};
  for (int k = 0; k < kDim - 1; ++k) {
    int row = k, pivot = k;
    double largest = 0.0;
    for (int i = k; i < kDim - 1; ++i) {
      for (int j = k; j < kDim; ++j) {
        const double size = std::abs(rows(i, column[j]));
        if (size > largest) {
          largest = size;
          row = i;
          pivot = j;
        }
      }
    }
    if (largest < 1e-14) return std::nullopt;
    if (row != k) rows.row(row).swap(rows.row(k));
    std::swap(column[k], column[pivot]);
    for (int i = k + 1; i < kDim - 1; ++i) {
      const double factor = rows(i, column[k]) / rows(k, column[k]);
      if (factor == 0.0) continue;
      for (int j = k; j < kDim; ++j) {
        rows(i, column[j]) -= factor * rows(k, column[j]);
      }
    }
  }
  Eigen::Vector<double, 6> normal;
  normal[column[kDim - 1]] = 1.0;
  for (int k = kDim - 2; k >= 0; --k) {
    double sum = 0.0;
    for (int j = k + 1; j < kDim; ++j) {
      sum += rows(k, column[j]) * normal[column[j]];
    }
    normal[column[k]] = -sum / rows(k, column[k]);
  }
  return normal.normalized();
}

}  // namespace graspdb
