#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace graspdb {

/** Linear equations of a body with six unknowns and of joints that act on it:
 A x = b, where A is symmetric and positive definite and joints of different
 groups are coupled through the body only. */
class ArrowSystem {
 public:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  /** All zero. @param couples  The pairs of joints, k < l, whose equations may
   share both unknowns. Those that are connected form a group. */
  ArrowSystem(int num_joints, const std::vector<std::pair<int, int>>& couples);

  void SetZero();

  /** The body's block of A … */
  Matrix6& body() { return body_; }
  /** … its column of joint k … */
  auto coupling(int k) { return coupling_.col(k); }
  /** … and the element of joints k >= l of one group. */
  double& joint(int k, int l) { return joints_(k, l); }
  /** The body's part of b, and joint k's. */
  Vector6& body_right() { return body_right_; }
  double& right(int k) { return right_[k]; }

  /** Solves, and leaves the equations in pieces.
   @param[out] x  The body's six unknowns, then the joints'. */
  void Solve(Eigen::VectorXd& x);

 private:
  // Per joint, those of its group < k; copies share it.
  std::shared_ptr<const std::vector<std::vector<int>>> before_;
  Matrix6 body_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> coupling_;
  Eigen::MatrixXd joints_;
  Vector6 body_right_;
  Eigen::VectorXd right_;
};

}  // namespace graspdb
