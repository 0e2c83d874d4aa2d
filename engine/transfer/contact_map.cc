#include "engine/transfer/contact_map.h"

#include <cmath>
#include <utility>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// Nearest first, so many at a time, until a normal passes the gate.
constexpr int kGateBatch = 16;
// Farther apart than this share of the set, no correspondence is meaningful.
constexpr int kMaxGateTries = 256;

// The index of the sample nearest to p whose normal is within the gate of nhat.
int FindNearestGated(const KdTree& tree, const SurfaceSamples& samples,
                     const Eigen::Vector3d& p, const Eigen::Vector3d& nhat,
                     double min_cosine) {
  size_t seen = 0;
  for (int count = kGateBatch; count <= kMaxGateTries; count *= 4) {
    const auto nearest = tree.FindNearest(p, count);
    for (; seen < nearest.size(); ++seen) {
      const int i = nearest[seen].index;
      if (samples.normals[i].dot(nhat) > min_cosine) return i;
    }
    if (static_cast<int>(nearest.size()) < count) break;
  }
  return -1;
}

// The mean of the images of the nearest samples around p, of similar normal.
std::optional<Eigen::Vector3d> CalcMeanImage(
    const KdTree& tree, const SurfaceSamples& from,
    const std::vector<int>& image, const SurfaceSamples& to,
    const Eigen::Vector3d& p, const Eigen::Vector3d& nhat, int neighbours,
    double min_cosine) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  // Some neighbours lie on the other side of a thin wall: look at more.
  for (const KdTree::Neighbour& near : tree.FindNearest(p, 4 * neighbours)) {
    if (from.normals[near.index].dot(nhat) <= min_cosine) continue;
    if (image[near.index] < 0) continue;
    sum += to.points[image[near.index]];
    if (++count == neighbours) break;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

}  // namespace

ContactMap::ContactMap(SurfaceSamples samples_E, SurfaceSamples samples_N,
                       const SurfaceSamples& moved_E,
                       const SurfaceIndex& index_E, const SurfaceIndex& index_N,
                       const MappingParameters& parameters)
    : samples_E_(std::move(samples_E)),
      samples_N_(std::move(samples_N)),
      index_E_(&index_E),
      index_N_(&index_N),
      parameters_(parameters),
      tree_E_(samples_E_.points),
      tree_N_(samples_N_.points) {
  GRASPDB_EXPECTS(samples_E_.size() > 0 && samples_N_.size() > 0);
  GRASPDB_EXPECTS(moved_E.size() == samples_E_.size());
  Eigen::Vector3d low = samples_E_.points[0], high = samples_E_.points[0];
  for (int i = 0; i < samples_E_.size(); ++i) {
    low = low.cwiseMin(samples_E_.points[i]);
    high = high.cwiseMax(samples_E_.points[i]);
  }
  max_error_ = parameters.consistency * (high - low).norm();
  const KdTree tree_moved_E(moved_E.points);
  const double min_cosine = std::cos(parameters.max_normal_angle);
  for (int i = 0; i < samples_E_.size(); ++i) {
    forward_.push_back(FindNearestGated(tree_N_, samples_N_, moved_E.points[i],
                                        moved_E.normals[i], min_cosine));
  }
  for (int i = 0; i < samples_N_.size(); ++i) {
    backward_.push_back(FindNearestGated(tree_moved_E, moved_E,
                                         samples_N_.points[i],
                                         samples_N_.normals[i], min_cosine));
  }
}

std::optional<Eigen::Vector3d> ContactMap::MapForward(
    const Eigen::Vector3d& p_EX, const Eigen::Vector3d& nhat_E) const {
  const auto image = CalcMeanImage(tree_E_, samples_E_, forward_, samples_N_,
                                   p_EX, nhat_E, parameters_.neighbours,
                                   std::cos(parameters_.max_normal_angle));
  if (!image) return std::nullopt;
  return index_N_->FindClosest(*image)->p_M;
}

std::optional<Eigen::Vector3d> ContactMap::MapBackward(
    const Eigen::Vector3d& p_NY, const Eigen::Vector3d& nhat_N) const {
  const auto image = CalcMeanImage(tree_N_, samples_N_, backward_, samples_E_,
                                   p_NY, nhat_N, parameters_.neighbours,
                                   std::cos(parameters_.max_normal_angle));
  if (!image) return std::nullopt;
  return index_E_->FindClosest(*image)->p_M;
}

std::optional<double> ContactMap::CalcRoundTripError(
    const Eigen::Vector3d& p_EX, const Eigen::Vector3d& nhat_E) const {
  const auto image = MapForward(p_EX, nhat_E);
  if (!image) return std::nullopt;
  const auto back =
      MapBackward(*image, index_N_->FindClosest(*image)->pseudonormal);
  if (!back) return std::nullopt;
  return (*back - p_EX).norm();
}

std::optional<Eigen::Vector3d> ContactMap::MapConsistently(
    const Eigen::Vector3d& p_EX, const Eigen::Vector3d& nhat_E) const {
  const auto error = CalcRoundTripError(p_EX, nhat_E);
  if (!error || *error >= max_error_) return std::nullopt;
  return MapForward(p_EX, nhat_E);
}

double ContactMap::CalcMappedShare() const {
  int mapped = 0;
  for (int i = 0; i < samples_E_.size(); ++i) {
    mapped += MapConsistently(samples_E_.points[i], samples_E_.normals[i])
                  .has_value();
  }
  return static_cast<double>(mapped) / samples_E_.size();
}

}  // namespace graspdb
