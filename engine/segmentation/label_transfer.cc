#include "engine/segmentation/label_transfer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "engine/base/contract.h"
#include "engine/math/kd_tree.h"
#include "engine/segmentation/label_cut.h"

namespace graspdb {
namespace {

constexpr int kNeighbours = 3;
constexpr double kConcavity = 16.0 / std::numbers::pi;
constexpr double kConvexity = 2.0 / std::numbers::pi;
constexpr double kValleyCost = 0.05;

using Vector6d = Eigen::Matrix<double, 6, 1>;

Vector6d MakePoint6(const Eigen::Vector3d& position,
                    const Eigen::Vector3d& normal, double radius,
                    double normal_weight) {
  Vector6d point;
  point << position / radius, normal_weight * normal;
  return point;
}

// The cost of a border over a link, per rms radius of its length. In the
// sharpest valley it is not free, so that borders do not wander in fillets.
double CalcBorderCost(const FaceLink& link) {
  if (link.angle >= 0.0) return 1.0 + kConvexity * link.angle;
  return kValleyCost + (1.0 - kValleyCost) * std::exp(kConcavity * link.angle);
}

}  // namespace

std::vector<std::vector<double>> CalcLabelCosts(
    const TriangleMesh& mesh_N, const SurfaceSamples& samples_E,
    const std::vector<int>& sample_labels, int num_labels,
    const AffineMap& map_NE, double radius,
    const SegmentationParameters& parameters) {
  GRASPDB_EXPECTS(static_cast<int>(sample_labels.size()) == samples_E.size());
  const double scale = 0.5 / (parameters.unary_sigma * parameters.unary_sigma);
  std::vector<std::vector<double>> costs(
      num_labels, std::vector<double>(mesh_N.num_triangles(),
                                      std::numeric_limits<double>::infinity()));
  for (int label = 0; label < num_labels; ++label) {
    std::vector<Vector6d> points;
    for (int i = 0; i < samples_E.size(); ++i) {
      if (sample_labels[i] != label) continue;
      points.push_back(MakePoint6(map_NE * samples_E.points[i],
                                  map_NE.MapNormal(samples_E.normals[i]),
                                  radius, parameters.normal_weight));
    }
    if (points.empty()) continue;
    const KdTree tree(Eigen::MatrixXd(Eigen::Map<const Eigen::MatrixXd>(
        points.front().data(), 6, static_cast<int>(points.size()))));
    for (int f = 0; f < mesh_N.num_triangles(); ++f) {
      const auto nearest =
          tree.FindNearest(MakePoint6(mesh_N.centroid(f), mesh_N.normal(f),
                                      radius, parameters.normal_weight),
                           kNeighbours);
      double sum = 0.0;
      for (const auto& neighbour : nearest) sum += neighbour.squared_distance;
      costs[label][f] = scale * sum / static_cast<double>(nearest.size());
    }
  }
  for (int f = 0; f < mesh_N.num_triangles(); ++f) {
    double least = costs[0][f];
    for (const auto& row : costs) least = std::min(least, row[f]);
    for (auto& row : costs) {
      row[f] = std::min(row[f] - least, parameters.unary_cap);
    }
  }
  return costs;
}

std::vector<int> CutByLabelCosts(const TriangleMesh& mesh_N,
                                 const std::vector<FaceLink>& links,
                                 const std::vector<std::vector<double>>& costs,
                                 double radius,
                                 const SegmentationParameters& parameters) {
  const int num_labels = static_cast<int>(costs.size());
  const int num_faces = mesh_N.num_triangles();
  std::vector<std::vector<double>> weighted = costs;
  for (int f = 0; f < num_faces; ++f) {
    for (int label = 0; label < num_labels; ++label) {
      weighted[label][f] *= mesh_N.area(f) / (radius * radius);
    }
  }
  std::vector<double> link_costs;
  link_costs.reserve(links.size());
  for (const FaceLink& link : links) {
    link_costs.push_back(parameters.pairwise_weight * link.length / radius *
                         CalcBorderCost(link));
  }
  return MergeIslands(mesh_N, links, CutLabels(weighted, links, link_costs),
                      parameters.min_island_share);
}

std::vector<double> CalcLabelConfidence(
    const TriangleMesh& mesh_N, const std::vector<int>& face_labels,
    const std::vector<std::vector<double>>& costs) {
  std::vector<double> confidence(costs.size(), 0.0);
  std::vector<double> area(costs.size(), 0.0);
  for (int f = 0; f < mesh_N.num_triangles(); ++f) {
    double total = 0.0;
    for (const auto& row : costs) total += std::exp(-row[f]);
    const int label = face_labels[f];
    confidence[label] += mesh_N.area(f) * std::exp(-costs[label][f]) / total;
    area[label] += mesh_N.area(f);
  }
  for (size_t label = 0; label < costs.size(); ++label) {
    if (area[label] > 0.0) confidence[label] /= area[label];
  }
  return confidence;
}

}  // namespace graspdb
