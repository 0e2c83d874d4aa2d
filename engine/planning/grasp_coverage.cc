#include "engine/planning/grasp_coverage.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

constexpr int kRegions = 8;

// Each farthest from those before; the first farthest from the middle.
std::vector<Eigen::Vector3d> SpreadCenters(const TriangleMesh& part_O) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : part_O.vertices()) middle += p;
  middle /= part_O.num_vertices();
  std::vector<Eigen::Vector3d> centers;
  std::vector<double> distances;
  for (const Eigen::Vector3d& p : part_O.vertices()) {
    distances.push_back((p - middle).norm());
  }
  while (centers.size() < kRegions) {
    const auto farthest = std::max_element(distances.begin(), distances.end());
    const auto v =
        static_cast<size_t>(std::distance(distances.begin(), farthest));
    // Only now do distances to centres count.
    if (centers.empty()) {
      distances.assign(distances.size(), std::numeric_limits<double>::max());
    }
    centers.push_back(part_O.vertices()[v]);
    for (size_t i = 0; i < distances.size(); ++i) {
      distances[i] = std::min(distances[i],
                              (part_O.vertices()[i] - centers.back()).norm());
    }
  }
  return centers;
}

}  // namespace

int FindApproach(const Eigen::Vector3d& direction) {
  int best = 0, index = 0;
  double best_cosine = -2.0;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        const double cosine =
            direction.dot(Eigen::Vector3d(x, y, z).normalized());
        if (cosine > best_cosine) {
          best_cosine = cosine;
          best = index;
        }
        ++index;
      }
    }
  }
  return best;
}

GraspCoverage CalcGraspCoverage(const std::vector<Grasp>& grasps,
                                const TriangleMesh& part_O) {
  GRASPDB_EXPECTS(part_O.num_vertices() > 0);
  const std::vector<Eigen::Vector3d> centers = SpreadCenters(part_O);
  const auto find_region = [&centers](const Eigen::Vector3d& p_O) {
    return std::distance(
        centers.begin(),
        std::min_element(
            centers.begin(), centers.end(),
            [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
              return (a - p_O).squaredNorm() < (b - p_O).squaredNorm();
            }));
  };
  std::set<int> approaches;
  std::set<std::pair<int, std::ptrdiff_t>> pairs;
  for (const Grasp& grasp : grasps) {
    const int approach = FindApproach(grasp.approach_O);
    approaches.insert(approach);
    for (const Contact& contact : grasp.contacts) {
      pairs.emplace(approach, find_region(contact.p_O));
    }
  }
  return {static_cast<double>(approaches.size()) / kNumApproaches,
          static_cast<double>(pairs.size()) / (kNumApproaches * kRegions)};
}

}  // namespace graspdb
