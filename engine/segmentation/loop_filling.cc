#include "engine/segmentation/loop_filling.h"

#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// How much a squared chord counts beside the area: enough to tell between the
// triangulations of a planar loop, which all have the same area.
constexpr double kChordWeight = 0.02;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double CalcCost(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                const Eigen::Vector3d& c) {
  return 0.5 * (b - a).cross(c - a).norm() +
         kChordWeight * ((b - a).squaredNorm() + (c - b).squaredNorm() +
                         (a - c).squaredNorm());
}

}  // namespace

std::optional<std::vector<Eigen::Vector3i>> FillLoop(
    const std::vector<Eigen::Vector3d>& loop,
    const std::function<bool(int, int)>& is_forbidden) {
  const int n = static_cast<int>(loop.size());
  GRASPDB_EXPECTS(n >= 3);
  // cost(i, k): of the best triangulation of the polygon i, i + 1, …, k, whose
  // triangle at the chord (i, k) has its third corner at apex(i, k).
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(n, n, kInfinity);
  Eigen::MatrixXi apex = Eigen::MatrixXi::Zero(n, n);
  for (int i = 0; i + 1 < n; ++i) cost(i, i + 1) = 0.0;
  for (int length = 2; length < n; ++length) {
    for (int i = 0; i + length < n; ++i) {
      const int k = i + length;
      const bool is_loop_edge = i == 0 && k == n - 1;
      if (!is_loop_edge && is_forbidden(i, k)) continue;
      for (int j = i + 1; j < k; ++j) {
        const double below = cost(i, j) + cost(j, k);
        if (below >= cost(i, k)) continue;
        const double total = below + CalcCost(loop[i], loop[j], loop[k]);
        if (total >= cost(i, k)) continue;
        cost(i, k) = total;
        apex(i, k) = j;
      }
    }
  }
  if (cost(0, n - 1) == kInfinity) return std::nullopt;
  std::vector<Eigen::Vector3i> triangles;
  std::vector<std::pair<int, int>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, k] = open.back();
    open.pop_back();
    if (k - i < 2) continue;
    const int j = apex(i, k);
    triangles.emplace_back(i, j, k);
    open.emplace_back(i, j);
    open.emplace_back(j, k);
  }
  return triangles;
}

}  // namespace graspdb
