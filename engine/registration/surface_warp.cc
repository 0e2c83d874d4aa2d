#include "engine/registration/surface_warp.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/LU>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// Every so many-th sample carries a pull.
constexpr int kPullStride = 4;

// A displacement wanted at a point, rms radii.
struct Pull {
  Eigen::Vector3d at;
  Eigen::Vector3d by;
  double weight;
};

// What both directions' matches ask of the samples of E.
std::vector<Pull> FindPulls(const Eigen::Matrix3Xd& points_E,
                            const NormalizedSamples& N,
                            const SampleMatches& matches) {
  std::vector<Pull> pulls;
  const auto add = [&](int i, int j, double squared) {
    pulls.push_back({points_E.col(i), N.points.col(j) - points_E.col(i),
                     CalcRobustWeight(squared)});
  };
  for (int i = 0; i < points_E.cols(); i += kPullStride) {
    add(i, matches.N_of_E[i], matches.squared_E[i]);
  }
  for (int j = 0; j < N.points.cols(); j += kPullStride) {
    add(matches.E_of_N[j], j, matches.squared_N[j]);
  }
  return pulls;
}

// Moves a point by the kernel's mean of the pulls and turns its normal with it.
void Bend(const std::vector<Pull>& pulls, double width,
          Eigen::Ref<Eigen::Vector3d> point,
          Eigen::Ref<Eigen::Vector3d> normal) {
  const double scale = 1.0 / (width * width);
  double sum = 1e-9;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();     // ∂ sum
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();  // ∂ (sum · shift)
  for (const Pull& pull : pulls) {
    const Eigen::Vector3d apart = point - pull.at;
    const double squared = apart.squaredNorm() * scale;
    if (squared > 9.0) continue;
    const double kernel = pull.weight * std::exp(-0.5 * squared);
    const Eigen::Vector3d fall = -kernel * scale * apart;
    sum += kernel;
    shift += kernel * pull.by;
    slope += fall;
    gradient += pull.by * fall.transpose();
  }
  shift /= sum;
  AffineMap local;
  local.linear += (gradient - shift * slope.transpose()) / sum;
  point += shift;
  // A fold has no normal to go by: keep the old one.
  if (local.linear.determinant() > 0.1) normal = local.MapNormal(normal);
}

}  // namespace

SurfaceSamples MapSamples(const SurfaceSamples& samples_E,
                          const AffineMap& map_NE) {
  SurfaceSamples mapped = samples_E;
  for (int i = 0; i < mapped.size(); ++i) {
    mapped.points[i] = map_NE * samples_E.points[i];
    mapped.normals[i] = map_NE.MapNormal(samples_E.normals[i]);
  }
  return mapped;
}

SurfaceSamples WarpSamples(const SurfaceSamples& samples_E,
                           const SurfaceSamples& samples_N,
                           const MappingParameters& parameters) {
  GRASPDB_EXPECTS(std::min(samples_E.size(), samples_N.size()) >= 4);
  const NormalizedSamples N(samples_N);
  NormalizedSamples E(samples_E, N.radius);
  const AffineMap to_N{Eigen::Matrix3d::Identity(),
                       (E.centre - N.centre) / N.radius};
  E.points.colwise() += to_N.translation;
  for (int step = 0; step < parameters.warp_steps; ++step) {
    const double progress =
        static_cast<double>(step) / std::max(1, parameters.warp_steps - 1);
    const double width =
        parameters.warp_first_width *
        std::pow(parameters.warp_last_width / parameters.warp_first_width,
                 progress);
    const std::vector<Pull> pulls = FindPulls(
        E.points, N, MatchSamples(E, N, {}, parameters.normal_weight));
    for (int i = 0; i < E.points.cols(); ++i) {
      Bend(pulls, width, E.points.col(i), E.normals.col(i));
    }
  }
  SurfaceSamples warped = samples_E;
  for (int i = 0; i < warped.size(); ++i) {
    warped.points[i] = N.centre + N.radius * E.points.col(i);
    warped.normals[i] = E.normals.col(i);
  }
  return warped;
}

}  // namespace graspdb
