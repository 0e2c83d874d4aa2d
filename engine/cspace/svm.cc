#include "engine/cspace/svm.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <libsvm/svm.h>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// Kernel cache of one training, MB, taken as it fills: all that the default
// learns from, 4,000 labels, takes 64. Of 40,000 it holds a quarter. A server
// trains one at a time.
constexpr double kCacheMegabytes = 1500.0;

struct ModelDeleter {
  void operator()(svm_model* model) const {
    svm_free_and_destroy_model(&model);
  }
};

}  // namespace

Svm::Svm(const Eigen::MatrixXd& features, const std::vector<bool>& labels,
         double penalty, double gamma)
    : gamma_(gamma) {
  const int count = static_cast<int>(features.cols());
  const int dimension = static_cast<int>(features.rows());
  GRASPDB_EXPECTS(count == static_cast<int>(labels.size()));
  GRASPDB_EXPECTS(std::count(labels.begin(), labels.end(), true) > 0 &&
                  std::count(labels.begin(), labels.end(), false) > 0);
  svm_set_print_string_function([](const char*) {});

  std::vector<double> targets(count);
  std::vector<svm_node> nodes(static_cast<size_t>(count) * (dimension + 1));
  std::vector<svm_node*> rows(count);
  for (int i = 0; i < count; ++i) {
    targets[i] = labels[i] ? 1.0 : -1.0;
    rows[i] = &nodes[static_cast<size_t>(i) * (dimension + 1)];
    for (int k = 0; k < dimension; ++k) rows[i][k] = {k + 1, features(k, i)};
    rows[i][dimension] = {-1, 0.0};
  }
  svm_problem problem{count, targets.data(), rows.data()};
  svm_parameter parameters{};
  parameters.svm_type = C_SVC;
  parameters.kernel_type = RBF;
  parameters.gamma = gamma;
  parameters.C = penalty;
  parameters.eps = 1e-2;
  parameters.cache_size = kCacheMegabytes;
  parameters.shrinking = 1;
  const std::unique_ptr<svm_model, ModelDeleter> model(
      svm_train(&problem, &parameters));

  support_vectors_.resize(model->l);
  points_.resize(dimension, model->l);
  coefficients_.resize(model->l);
  // libsvm calls the label that comes first positive.
  const double sign = model->label[0] > 0 ? 1.0 : -1.0;
  std::vector<int> indices(model->l);
  svm_get_sv_indices(model.get(), indices.data());
  for (int s = 0; s < model->l; ++s) {
    support_vectors_[s] = indices[s] - 1;
    points_.col(s) = features.col(indices[s] - 1);
    coefficients_[s] = sign * model->sv_coef[0][s];
  }
  offset_ = sign * model->rho[0];
  std::sort(support_vectors_.begin(), support_vectors_.end());
}

double Svm::CalcDecisionValue(const Eigen::VectorXd& features) const {
  // In a variable of its own, so that the exponentials are taken side by side.
  const Eigen::ArrayXd squared =
      (points_.colwise() - features).colwise().squaredNorm();
  return ((-gamma_ * squared).exp() * coefficients_.array()).sum() - offset_;
}

}  // namespace graspdb
