#include "engine/math/nonnegative_least_squares.h"

#include <algorithm>
#include <vector>

#include <Eigen/Cholesky>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

constexpr double kNoGain = 1e-9;
constexpr double kZero = 1e-12;
constexpr double kRidge = 1e-10;  // Columns may depend on each other.
constexpr int kRoundsPerColumn = 3;

// One search: which columns may be positive, the passive ones, and how much.
class ActiveSet {
 public:
  ActiveSet(const Eigen::MatrixXd& gram, const Eigen::VectorXd& Atb,
            const Eigen::VectorXd& start)
      : gram_(gram), Atb_(Atb), x_(start) {
    for (Eigen::Index i = 0; i < x_.size(); ++i) {
      if (x_[i] > 0.0) passive_.push_back(i);
    }
  }

  Eigen::VectorXd Run() {
    bool moves = passive_.empty() || Settle();
    for (Eigen::Index round = 0; moves && round < kRoundsPerColumn * x_.size();
         ++round) {
      const Eigen::Index best = FindBestAtRest();
      if (best < 0) break;
      passive_.push_back(best);
      moves = Settle();
    }
    return x_;
  }

 private:
  // Of the columns at rest, the one that gains most; -1 when none does.
  Eigen::Index FindBestAtRest() {
    gain_ = Atb_;
    for (const Eigen::Index i : passive_) gain_ -= x_[i] * gram_.col(i);
    for (const Eigen::Index i : passive_) gain_[i] = 0.0;
    Eigen::Index best = 0;
    return gain_.maxCoeff(&best) > kNoGain ? best : -1;
  }

  // Moves the passive columns to their optimum; those that would be negative
  // on the way rest. False when rounding leaves no progress.
  bool Settle() {
    while (!passive_.empty()) {
      SolvePassive();
      if (s_.minCoeff() > kZero) {
        for (size_t k = 0; k < passive_.size(); ++k) {
          x_[passive_[k]] = s_[static_cast<Eigen::Index>(k)];
        }
        return true;
      }
      // As far towards s as all stay positive; what is zero then rests.
      double step = 1.0;
      for (size_t k = 0; k < passive_.size(); ++k) {
        const double target = s_[static_cast<Eigen::Index>(k)];
        const double here = x_[passive_[k]];
        if (target <= kZero) step = std::min(step, here / (here - target));
      }
      size_t still = 0;
      for (size_t k = 0; k < passive_.size(); ++k) {
        const Eigen::Index i = passive_[k];
        x_[i] += step * (s_[static_cast<Eigen::Index>(k)] - x_[i]);
        if (x_[i] > kZero) {
          passive_[still++] = i;
        } else {
          x_[i] = 0.0;
        }
      }
      if (still == passive_.size()) return false;
      passive_.resize(still);
    }
    return true;
  }

  // The least-squares solution in the passive columns alone.
  void SolvePassive() {
    const auto k = static_cast<Eigen::Index>(passive_.size());
    G_.resize(k, k);
    s_.resize(k);
    for (Eigen::Index j = 0; j < k; ++j) {
      const Eigen::Index p = passive_[static_cast<size_t>(j)];
      for (Eigen::Index i = j; i < k; ++i) {
        G_(i, j) = gram_(passive_[static_cast<size_t>(i)], p);
      }
      G_(j, j) += kRidge;
      s_[j] = Atb_[p];
    }
    cholesky_.compute(G_);
    cholesky_.solveInPlace(s_);
  }

  const Eigen::MatrixXd& gram_;
  const Eigen::VectorXd& Atb_;
  Eigen::VectorXd x_;
  std::vector<Eigen::Index> passive_;
  Eigen::MatrixXd G_;  // Its lower half.
  Eigen::LLT<Eigen::MatrixXd, Eigen::Lower> cholesky_;
  Eigen::VectorXd s_;
  Eigen::VectorXd gain_;
};

}  // namespace

NonnegativeLeastSquares::NonnegativeLeastSquares(const Eigen::MatrixXd& A)
    : A_(A), gram_(A.transpose() * A) {}

Eigen::VectorXd NonnegativeLeastSquares::Solve(const Eigen::VectorXd& b) const {
  return Solve(b, Eigen::VectorXd::Zero(A_.cols()));
}

Eigen::VectorXd NonnegativeLeastSquares::Solve(
    const Eigen::VectorXd& b, const Eigen::VectorXd& start) const {
  GRASPDB_EXPECTS(b.size() == A_.rows() && start.size() == A_.cols());
  const Eigen::VectorXd Atb = A_.transpose() * b;
  return ActiveSet(gram_, Atb, start).Run();
}

}  // namespace graspdb
