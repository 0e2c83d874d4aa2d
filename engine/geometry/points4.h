#pragma once

#include <Eigen/Core>

#include "engine/math/lanes.h"

namespace graspdb {

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
