#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "engine/math/kd_tree.h"

namespace graspdb {

/** Where a surface that was made from a point cloud is supported by points.
 Immutable, shared by threads. */
class SeenSurface {
 public:
  /** @param points_O  Of the cloud, m. @pre Not empty.
   @param reach  A point this near shows a place, m. */
  SeenSurface(const std::vector<Eigen::Vector3d>& points_O, double reach)
      : points_O_(points_O), reach_(reach) {}

  bool Shows(const Eigen::Vector3d& p_O) const {
    return points_O_.FindNearest(p_O).squared_distance <= reach_ * reach_;
  }

 private:
  KdTree points_O_;
  double reach_;
};

}  // namespace graspdb
