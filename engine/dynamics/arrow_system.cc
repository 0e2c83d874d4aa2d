#include "engine/dynamics/arrow_system.h"

#include <algorithm>
#include <numeric>

#include <Eigen/Cholesky>

namespace graspdb {

ArrowSystem::ArrowSystem(int num_joints,
                         const std::vector<std::pair<int, int>>& couples)
    : coupling_(6, num_joints),
      joints_(num_joints, num_joints),
      right_(num_joints) {
  std::vector<int> group(static_cast<size_t>(num_joints));
  std::iota(group.begin(), group.end(), 0);
  for (const auto& [k, l] : couples) {
    const int from = group[static_cast<size_t>(l)];
    const int to = group[static_cast<size_t>(k)];
    std::replace(group.begin(), group.end(), from, to);
  }
  std::vector<std::vector<int>> before(static_cast<size_t>(num_joints));
  for (int k = 0; k < num_joints; ++k) {
    for (int l = 0; l < k; ++l) {
      if (group[static_cast<size_t>(l)] == group[static_cast<size_t>(k)]) {
        before[static_cast<size_t>(k)].push_back(l);
      }
    }
  }
  before_ =
      std::make_shared<const std::vector<std::vector<int>>>(std::move(before));
  SetZero();
}

void ArrowSystem::SetZero() {
  body_.setZero();
  coupling_.setZero();
  joints_.setZero();
  body_right_.setZero();
  right_.setZero();
}

void ArrowSystem::Solve(Eigen::VectorXd& x) {
  const auto n = static_cast<int>(right_.size());
  // Gauss: the joints from the last one on, each from its group and the body.
  for (int k = n - 1; k >= 0; --k) {
    const double inverse = 1.0 / joints_(k, k);
    const Vector6 scaled = inverse * coupling_.col(k);
    const std::vector<int>& before = (*before_)[static_cast<size_t>(k)];
    for (const int l : before) {
      const double factor = inverse * joints_(k, l);
      if (factor == 0.0) continue;
      for (const int m : before) {
        if (m > l) break;
        joints_(l, m) -= factor * joints_(k, m);
      }
      coupling_.col(l) -= factor * coupling_.col(k);
      right_[l] -= factor * right_[k];
    }
    body_.noalias() -= scaled * coupling_.col(k).transpose();
    body_right_ -= right_[k] * scaled;
  }
  x.resize(6 + n);
  const Vector6 body = body_.llt().solve(body_right_);
  x.head<6>() = body;
  for (int k = 0; k < n; ++k) {
    double rest = right_[k] - coupling_.col(k).dot(body);
    for (const int l : (*before_)[static_cast<size_t>(k)]) {
      rest -= joints_(k, l) * x[6 + l];
    }
    x[6 + k] = rest / joints_(k, k);
  }
}

}  // namespace graspdb
