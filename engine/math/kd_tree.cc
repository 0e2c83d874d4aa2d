#include "engine/math/kd_tree.h"

#include <algorithm>
#include <utility>

#include <nanoflann.hpp>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// What nanoflann asks of a set of points.
struct PointSet {
  size_t kdtree_get_point_count() const {
    return static_cast<size_t>(points.cols());
  }
  double kdtree_get_pt(int index, size_t row) const {
    return points(static_cast<Eigen::Index>(row), index);
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
  Eigen::MatrixXd points;
};

template <int dimension>
using Tree = nanoflann::KDTreeSingleIndexAdaptor<
    nanoflann::L2_Simple_Adaptor<double, PointSet, double, int>, PointSet,
    dimension, int>;

bool IsNearer(const KdTree::Neighbour& a, const KdTree::Neighbour& b) {
  return std::pair(a.squared_distance, a.index) <
         std::pair(b.squared_distance, b.index);
}

}  // namespace

class KdTree::Index {
 public:
  explicit Index(Eigen::MatrixXd points) : set_{std::move(points)} {
    GRASPDB_EXPECTS(set_.points.rows() > 0 && set_.points.cols() > 0);
    const int dimension = static_cast<int>(set_.points.rows());
    // The dimensions known at compile time have unrolled distance loops.
    if (dimension == 3) {
      tree3_ = MakeTree<3>(dimension);
    } else if (dimension == 6) {
      tree6_ = MakeTree<6>(dimension);
    } else {
      tree_ = MakeTree<-1>(dimension);
    }
  }

  const Eigen::MatrixXd& points() const { return set_.points; }

  std::vector<Neighbour> FindNearest(const double* query, int count) const {
    const int wanted = std::min(count, static_cast<int>(set_.points.cols()));
    std::vector<int> indices(wanted);
    std::vector<double> distances(wanted);
    const int found = Search(query, wanted, indices.data(), distances.data());
    std::vector<Neighbour> result(found);
    for (int i = 0; i < found; ++i) result[i] = {indices[i], distances[i]};
    std::sort(result.begin(), result.end(), IsNearer);
    return result;
  }

  Neighbour FindNearest(const double* query) const {
    Neighbour result;
    Search(query, 1, &result.index, &result.squared_distance);
    return result;
  }

  std::vector<Neighbour> FindWithin(const double* query, double radius) const {
    std::vector<std::pair<int, double>> matches;
    Visit([&](const auto& tree) {
      tree.radiusSearch(query, radius * radius, matches,
                        nanoflann::SearchParams(0, 0.0f, false));
      return 0;
    });
    std::vector<Neighbour> result;
    result.reserve(matches.size());
    for (const auto& [index, distance] : matches) {
      result.push_back({index, distance});
    }
    std::sort(result.begin(), result.end(), IsNearer);
    return result;
  }

 private:
  template <int dimension>
  std::unique_ptr<Tree<dimension>> MakeTree(int runtime_dimension) {
    return std::make_unique<Tree<dimension>>(
        runtime_dimension, set_, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  }

  template <class F>
  int Visit(F&& f) const {
    if (tree3_) return f(*tree3_);
    if (tree6_) return f(*tree6_);
    return f(*tree_);
  }

  int Search(const double* query, int count, int* indices,
             double* distances) const {
    return Visit([&](const auto& tree) {
      nanoflann::KNNResultSet<double, int> found(count);
      found.init(indices, distances);
      tree.findNeighbors(found, query, nanoflann::SearchParams());
      return static_cast<int>(found.size());
    });
  }

  PointSet set_;
  std::unique_ptr<Tree<3>> tree3_;
  std::unique_ptr<Tree<6>> tree6_;
  std::unique_ptr<Tree<-1>> tree_;
};

KdTree::KdTree(Eigen::MatrixXd points)
    : index_(std::make_unique<Index>(std::move(points))) {}

KdTree::KdTree(const std::vector<Eigen::Vector3d>& points)
    : KdTree(points.empty()
                 ? Eigen::MatrixXd()
                 : Eigen::MatrixXd(Eigen::Map<const Eigen::Matrix3Xd>(
                       points.front().data(), 3,
                       static_cast<int>(points.size())))) {}

KdTree::KdTree(KdTree&&) noexcept = default;
KdTree& KdTree::operator=(KdTree&&) noexcept = default;
KdTree::~KdTree() = default;

const Eigen::MatrixXd& KdTree::points() const { return index_->points(); }

KdTree::Neighbour KdTree::FindNearest(
    const Eigen::Ref<const Eigen::VectorXd>& query) const {
  GRASPDB_EXPECTS(query.size() == points().rows());
  return index_->FindNearest(query.data());
}

std::vector<KdTree::Neighbour> KdTree::FindNearest(
    const Eigen::Ref<const Eigen::VectorXd>& query, int count) const {
  GRASPDB_EXPECTS(query.size() == points().rows() && count > 0);
  return index_->FindNearest(query.data(), count);
}

std::vector<KdTree::Neighbour> KdTree::FindWithin(
    const Eigen::Ref<const Eigen::VectorXd>& query, double radius) const {
  GRASPDB_EXPECTS(query.size() == points().rows());
  return index_->FindWithin(query.data(), radius);
}

}  // namespace graspdb
