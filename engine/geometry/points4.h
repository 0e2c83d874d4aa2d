#pragma once

#include <Eigen/Core>

namespace graspdb {

/** Four numbers of single precision at once, as every processor has them. */
using Floats4 = float __attribute__((vector_size(16)));
using Ints4 = int __attribute__((vector_size(16)));

/** Four points, m. */
struct Points4 {
  Floats4 x{};
  Floats4 y{};
  Floats4 z{};

  void Set(int lane, const Eigen::Vector3d& p) {
    x[lane] = static_cast<float>(p.x());
    y[lane] = static_cast<float>(p.y());
    z[lane] = static_cast<float>(p.z());
  }
};

}  // namespace graspdb
