#pragma once

#include <Eigen/Core>

namespace graspdb {

/** Minimises |A x - b| over x >= 0 for many b. Active sets [Lawson and Hanson
 1974] on the normal equations [Bro and de Jong 1997]: for a few dozen columns
 of about unit size. Deterministic. */
class NonnegativeLeastSquares {
 public:
  /** @param A  m x n. */
  explicit NonnegativeLeastSquares(const Eigen::MatrixXd& A);

  /** The x that is found, n. @param start  Where the search sets out, n and not
   negative: what another b's was is near; zero by default. @pre b has m rows.
 */
  Eigen::VectorXd Solve(const Eigen::VectorXd& b) const;
  Eigen::VectorXd Solve(const Eigen::VectorXd& b,
                        const Eigen::VectorXd& start) const;

 private:
  Eigen::MatrixXd A_;
  Eigen::MatrixXd gram_;  // Aᵀ A
};

}  // namespace graspdb
