#include "engine/math/nonnegative_least_squares.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

namespace graspdb {
namespace {

constexpr double kNoGain = 1e-9;
constexpr double kZero = 1e-12;
constexpr double kRidge = 1e-10;  // Columns may depend on each other.
constexpr int kRoundsPerColumn = 3;

}  // namespace

NonnegativeLeastSquares::NonnegativeLeastSquares(const Eigen::MatrixXd& A)
    : A_(A), gram_(A.transpose() * A) {}

Eigen::VectorXd NonnegativeLeastSquares::Solve(const Eigen::VectorXd& b) const {
  const Eigen::Index n = A_.cols();
  const Eigen::VectorXd Atb = A_.transpose() * b;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Index> passive;  // Where x may be positive.
  std::vector<bool> is_passive(static_cast<size_t>(n), false);
  const auto solve_passive = [&] {
    const auto k = static_cast<Eigen::Index>(passive.size());
    Eigen::MatrixXd G(k, k);
    Eigen::VectorXd c(k);
    for (Eigen::Index i = 0; i < k; ++i) {
      const Eigen::Index p = passive[static_cast<size_t>(i)];
      for (Eigen::Index j = 0; j < k; ++j) {
        G(i, j) = gram_(p, passive[static_cast<size_t>(j)]);
      }
      G(i, i) += kRidge;
      c[i] = Atb[p];
    }
    return Eigen::VectorXd(G.llt().solve(c));
  };
  for (Eigen::Index round = 0; round < kRoundsPerColumn * n; ++round) {
    // Of the columns at rest, the one that gains most moves.
    const Eigen::VectorXd gain = Atb - gram_ * x;
    Eigen::Index best = -1;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!is_passive[static_cast<size_t>(i)] && gain[i] > kNoGain &&
          (best < 0 || gain[i] > gain[best])) {
        best = i;
      }
    }
    if (best < 0) break;
    passive.push_back(best);
    is_passive[static_cast<size_t>(best)] = true;
    while (!passive.empty()) {
      const Eigen::VectorXd s = solve_passive();
      if (s.minCoeff() > kZero) {
        for (size_t k = 0; k < passive.size(); ++k) {
          x[passive[k]] = s[static_cast<Eigen::Index>(k)];
        }
        break;
      }
      // As far towards s as all stay positive; what is zero then rests.
      double step = 1.0;
      for (size_t k = 0; k < passive.size(); ++k) {
        const double target = s[static_cast<Eigen::Index>(k)];
        const double here = x[passive[k]];
        if (target <= kZero) step = std::min(step, here / (here - target));
      }
      std::vector<Eigen::Index> still;
      for (size_t k = 0; k < passive.size(); ++k) {
        const Eigen::Index i = passive[k];
        x[i] += step * (s[static_cast<Eigen::Index>(k)] - x[i]);
        if (x[i] > kZero) {
          still.push_back(i);
        } else {
          x[i] = 0.0;
          is_passive[static_cast<size_t>(i)] = false;
        }
      }
      if (still.size() == passive.size()) return x;  // Rounding: no progress.
      passive = std::move(still);
    }
  }
  return x;
}

}  // namespace graspdb
