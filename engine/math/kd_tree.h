#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

namespace graspdb {

/** Exact nearest neighbours among fixed points of any dimension; fastest for 3
 (positions) and 6 (positions with weighted normals). Queries are const and may
 run on many threads at once. */
class KdTree {
 public:
  struct Neighbour {
    int index{0};  ///< Column of the points.
    double squared_distance{0.0};

    bool operator==(const Neighbour&) const = default;
  };

  /** Over the columns of `points`. @pre At least one row and one column. */
  explicit KdTree(Eigen::MatrixXd points);
  explicit KdTree(const std::vector<Eigen::Vector3d>& points);
  KdTree(KdTree&&) noexcept;
  KdTree& operator=(KdTree&&) noexcept;
  ~KdTree();

  const Eigen::MatrixXd& points() const;

  /** @pre query has as many rows as the points, all finite. */
  Neighbour FindNearest(const Eigen::Ref<const Eigen::VectorXd>& query) const;
  /** The `count` nearest (all points when there are fewer), nearest first. */
  std::vector<Neighbour> FindNearest(
      const Eigen::Ref<const Eigen::VectorXd>& query, int count) const;
  /** All points nearer than `radius`, nearest first. */
  std::vector<Neighbour> FindWithin(
      const Eigen::Ref<const Eigen::VectorXd>& query, double radius) const;

 private:
  class Index;
  std::unique_ptr<const Index> index_;
};

}  // namespace graspdb
