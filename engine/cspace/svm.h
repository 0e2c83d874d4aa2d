#pragma once

#include <vector>

#include <Eigen/Core>

namespace graspdb {

/** A two-class support vector machine with the kernel exp(-γ |x - y|²).
 Immutable, shared by threads. */
class Svm {
 public:
  /** Trains on one column of `features` per sample, `labels` true or false.
   @param penalty  C. @param gamma  γ.
   @pre Both labels occur. Deterministic. */
  Svm(const Eigen::MatrixXd& features, const std::vector<bool>& labels,
      double penalty, double gamma);

  /** Positive where the machine says true; zero on the decision boundary. */
  double CalcDecisionValue(const Eigen::VectorXd& features) const;

  /** The training samples that are support vectors, ascending. */
  const std::vector<int>& support_vectors() const { return support_vectors_; }

 private:
  std::vector<int> support_vectors_;
  Eigen::MatrixXd points_;        // One column per support vector.
  Eigen::VectorXd coefficients_;  // Signed so that true is positive.
  double offset_{0.0};
  double gamma_{0.0};
};

}  // namespace graspdb
