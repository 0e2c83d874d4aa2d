#include "engine/registration/surface_warp.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "engine/base/contract.h"
#include "engine/math/lanes.h"

namespace graspdb {
namespace {

// Every so many-th sample carries a pull.
constexpr int kPullStride = 4;
// The kernel (1 - r²/e²)⁴ is much like a Gaussian of unit width, and zero from
// here on, widths.
constexpr float kKernelEnd = 3.0f;
// What stands against the pulls where there are none.
constexpr double kNoPull = 1e-9;

// Where each pull is, which way it goes, rms radii, and its weight.
using Pulls = Eigen::Matrix<float, 7, Eigen::Dynamic>;

// Over the pulls at a point: the kernel (row 0), the kernel times the pull (1
// to 3), and the slopes of these (4 to 6, 7 to 15 by rows).
using Sums = Eigen::Matrix<float, 16, Eigen::Dynamic>;

// What both directions' matches ask of the samples of E.
Pulls FindPulls(const Eigen::Matrix3Xd& points_E, const NormalizedSamples& N,
                const SampleMatches& matches) {
  const auto count = [](Eigen::Index n) {
    return (n + kPullStride - 1) / kPullStride;
  };
  Pulls pulls(7, count(points_E.cols()) + count(N.points.cols()));
  Eigen::Index size = 0;
  const auto add = [&](int i, int j, double squared) {
    const Eigen::Vector3d at = points_E.col(i);
    const Eigen::Vector3d by = N.points.col(j) - at;
    pulls.col(size++) << at.cast<float>(), by.cast<float>(),
        static_cast<float>(CalcRobustWeight(squared));
  };
  for (int i = 0; i < points_E.cols(); i += kPullStride) {
    add(i, matches.N_of_E[i], matches.squared_E[i]);
  }
  for (int j = 0; j < N.points.cols(); j += kPullStride) {
    add(matches.E_of_N[j], j, matches.squared_N[j]);
  }
  return pulls;
}

// Each of the points side by side goes through the same operations in the same
// order, so that their number changes nothing.
template <class Floats>
[[gnu::always_inline]] inline void SumPullsInLanes(
    const Pulls& pulls, float width, const Eigen::Matrix3Xf& points,
    Sums& sums) {
  constexpr int lanes = sizeof(Floats) / sizeof(float);
  const auto num_points = static_cast<int>(points.cols());
  const float per_squared = 1.0f / (kKernelEnd * kKernelEnd * width * width);
  const Floats zero{};
  for (int begin = 0; begin < num_points; begin += lanes) {
    const int count = std::min(lanes, num_points - begin);
    Floats x[3] = {};
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < count; ++i) x[k][i] = points(k, begin + i);
    }
    Floats sum[16] = {};
    const float* pull = pulls.data();
    for (Eigen::Index j = 0; j < pulls.cols(); ++j, pull += 7) {
      const Floats d[3] = {x[0] - pull[0], x[1] - pull[1], x[2] - pull[2]};
      const Floats rest =
          1.0f - per_squared * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      const Floats t = rest > zero ? rest : zero;
      const Floats cubed = pull[6] * (t * t * t);
      const Floats kernel = cubed * t;
      const Floats fall = (-8.0f * per_squared) * cubed;
      sum[0] += kernel;
      for (int k = 0; k < 3; ++k) sum[1 + k] += kernel * pull[3 + k];
      for (int c = 0; c < 3; ++c) {
        const Floats slope = fall * d[c];
        sum[4 + c] += slope;
        for (int k = 0; k < 3; ++k) sum[7 + 3 * k + c] += slope * pull[3 + k];
      }
    }
    for (int row = 0; row < 16; ++row) {
      for (int i = 0; i < count; ++i) sums(row, begin + i) = sum[row][i];
    }
  }
}

#ifdef __x86_64__
[[gnu::target("avx2")]] void SumPullsWithAvx2(const Pulls& pulls, float width,
                                              const Eigen::Matrix3Xf& points,
                                              Sums& sums) {
  SumPullsInLanes<Floats8>(pulls, width, points, sums);
}
#endif

Sums SumPulls(const Pulls& pulls, double width,
              const Eigen::Matrix3Xd& points_E) {
  const Eigen::Matrix3Xf points = points_E.cast<float>();
  Sums sums(16, points.cols());
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2")) {
    SumPullsWithAvx2(pulls, static_cast<float>(width), points, sums);
    return sums;
  }
#endif
  SumPullsInLanes<Floats4>(pulls, static_cast<float>(width), points, sums);
  return sums;
}

// Moves each point by the kernel's mean of the pulls and turns its normal with
// it.
void Bend(const Pulls& pulls, double width, NormalizedSamples& E) {
  const Sums sums = SumPulls(pulls, width, E.points);
  for (Eigen::Index i = 0; i < E.points.cols(); ++i) {
    const Eigen::Matrix<double, 16, 1> sum = sums.col(i).cast<double>();
    const double kernel = sum[0] + kNoPull;
    const Eigen::Vector3d shift = sum.segment<3>(1) / kernel;
    const Eigen::Vector3d slope = sum.segment<3>(4);
    const Eigen::Matrix3d gradient =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(
            sum.data() + 7);
    AffineMap local;
    local.linear += (gradient - shift * slope.transpose()) / kernel;
    E.points.col(i) += shift;
    // A fold has no normal to go by: keep the old one.
    if (local.linear.determinant() > 0.1) {
      E.normals.col(i) = local.MapNormal(E.normals.col(i));
    }
  }
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
    Bend(FindPulls(E.points, N,
                   MatchSamples(E, N, {}, parameters.normal_weight)),
         width, E);
  }
  SurfaceSamples warped = samples_E;
  for (int i = 0; i < warped.size(); ++i) {
    warped.points[i] = N.centre + N.radius * E.points.col(i);
    warped.normals[i] = E.normals.col(i);
  }
  return warped;
}

}  // namespace graspdb
