#include "engine/segmentation/shape_diameter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <type_traits>
#include <utility>

#include <embree3/rtcore.h>
#include <Eigen/Geometry>

#include "engine/base/contract.h"
#include "engine/segmentation/label_transfer.h"

namespace graspdb {
namespace {

constexpr int kRays = 25;
constexpr double kConeAngle = std::numbers::pi / 3.0;  // From the axis.

template <class T>
using Handle = std::unique_ptr<std::remove_pointer_t<T>, void (*)(T)>;

// Rays against one mesh.
class RayCaster {
 public:
  explicit RayCaster(const TriangleMesh& mesh)
      : device_(rtcNewDevice("threads=1,set_affinity=0"), rtcReleaseDevice),
        scene_(rtcNewScene(device_.get()), rtcReleaseScene) {
    RTCGeometry geometry =
        rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
        3 * sizeof(float), mesh.vertices().size()));
    for (const Eigen::Vector3d& p : mesh.vertices()) {
      for (int k = 0; k < 3; ++k) *vertices++ = static_cast<float>(p[k]);
    }
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
        3 * sizeof(unsigned), mesh.triangles().size()));
    for (const Eigen::Vector3i& t : mesh.triangles()) {
      for (int k = 0; k < 3; ++k) *indices++ = static_cast<unsigned>(t[k]);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene_.get());
  }

  // The distance to the first face met, and that face; -1 for none.
  std::pair<double, int> Cast(const Eigen::Vector3d& origin,
                              const Eigen::Vector3d& direction,
                              double start) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray.org_x = static_cast<float>(origin.x());
    query.ray.org_y = static_cast<float>(origin.y());
    query.ray.org_z = static_cast<float>(origin.z());
    query.ray.dir_x = static_cast<float>(direction.x());
    query.ray.dir_y = static_cast<float>(direction.y());
    query.ray.dir_z = static_cast<float>(direction.z());
    query.ray.tnear = static_cast<float>(start);
    query.ray.tfar = std::numeric_limits<float>::infinity();
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {0.0, -1};
    return {query.ray.tfar, static_cast<int>(query.hit.primID)};
  }

 private:
  Handle<RTCDevice> device_;
  Handle<RTCScene> scene_;
};

struct ConeRay {
  Eigen::Vector3d direction;  // About +z.
  double weight{1.0};
};

// Directions spread evenly over the cone's disc (Vogel's spiral), the ones near
// the axis counting more.
std::vector<ConeRay> MakeCone() {
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::vector<ConeRay> rays;
  for (int i = 0; i < kRays; ++i) {
    const double radius = std::tan(kConeAngle) * std::sqrt((i + 0.5) / kRays);
    const Eigen::Vector3d direction(radius * std::cos(i * golden),
                                    radius * std::sin(i * golden), 1.0);
    rays.push_back({direction.normalized(), 1.0 / (0.1 + std::atan(radius))});
  }
  return rays;
}

// The weighted mean of the lengths within one standard deviation of the median.
double CalcRobustMean(std::vector<std::pair<double, double>> lengths) {
  if (lengths.empty()) return 0.0;
  std::sort(lengths.begin(), lengths.end());
  const double median = lengths[lengths.size() / 2].first;
  double variance = 0.0;
  for (const auto& [length, weight] : lengths) {
    variance += (length - median) * (length - median);
  }
  const double deviation =
      std::sqrt(variance / static_cast<double>(lengths.size()));
  double sum = 0.0;
  double total = 0.0;
  for (const auto& [length, weight] : lengths) {
    if (std::abs(length - median) > deviation) continue;
    sum += weight * length;
    total += weight;
  }
  return sum / total;
}

// One normal distribution of a mixture.
struct Component {
  double weight{1.0};
  double mean{0.0};
  double deviation{1.0};

  double CalcDensity(double x) const {
    const double z = (x - mean) / deviation;
    return weight / deviation * std::exp(-0.5 * z * z);
  }
};

constexpr int kMixtureSteps = 50;
constexpr double kMinDeviation = 0.01;  // Of values in [0, 1].
constexpr double kMinDensity = 1e-12;

// Expectation and maximisation from even quantiles.
std::vector<Component> FitMixture(const std::vector<double>& values,
                                  const std::vector<double>& areas, int count) {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  std::vector<Component> mixture(count);
  for (int k = 0; k < count; ++k) {
    mixture[k] = {1.0 / count,
                  sorted[(2 * k + 1) * sorted.size() / (2 * count)],
                  1.0 / count};
  }
  for (int step = 0; step < kMixtureSteps; ++step) {
    std::vector<Eigen::Vector3d> moments(count, Eigen::Vector3d::Zero());
    double total = 0.0;
    for (size_t f = 0; f < values.size(); ++f) {
      const double x = values[f];
      double sum = kMinDensity;
      for (const Component& c : mixture) sum += c.CalcDensity(x);
      for (int k = 0; k < count; ++k) {
        const double share = areas[f] * mixture[k].CalcDensity(x) / sum;
        moments[k] += share * Eigen::Vector3d(1.0, x, x * x);
      }
      total += areas[f];
    }
    for (int k = 0; k < count; ++k) {
      const double weight = moments[k][0];
      if (weight <= kMinDensity * total) continue;
      const double mean = moments[k][1] / weight;
      const double variance = moments[k][2] / weight - mean * mean;
      mixture[k] = {
          weight / total, mean,
          std::sqrt(std::max(variance, kMinDeviation * kMinDeviation))};
    }
  }
  std::sort(mixture.begin(), mixture.end(),
            [](const auto& a, const auto& b) { return a.mean < b.mean; });
  return mixture;
}

// Shapira's scale: [0, 1], finer for thin parts.
std::vector<double> ScaleLogarithmically(const std::vector<double>& diameters) {
  const auto [low, high] =
      std::minmax_element(diameters.begin(), diameters.end());
  const double range = std::max(*high - *low, 1e-300);
  std::vector<double> values;
  values.reserve(diameters.size());
  for (const double diameter : diameters) {
    values.push_back(std::log1p(4.0 * (diameter - *low) / range) /
                     std::log(5.0));
  }
  return values;
}

}  // namespace

std::vector<double> CalcShapeDiameters(const TriangleMesh& mesh) {
  const RayCaster caster(mesh);
  const std::vector<ConeRay> cone = MakeCone();
  const double start = 1e-5 * mesh.diagonal();
  std::vector<double> diameters(mesh.num_triangles(), 0.0);
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    if (mesh.area(f) == 0.0) continue;
    const auto R_MC = Eigen::Quaterniond::FromTwoVectors(
        Eigen::Vector3d::UnitZ(), -mesh.normal(f));
    std::vector<std::pair<double, double>> lengths;
    for (const ConeRay& ray : cone) {
      const Eigen::Vector3d direction = R_MC * ray.direction;
      const auto [length, hit] =
          caster.Cast(mesh.centroid(f), direction, start);
      // From inside, the far side's normal points along the ray.
      if (hit < 0 || mesh.normal(hit).dot(direction) <= 0.0) continue;
      lengths.emplace_back(length, ray.weight);
    }
    diameters[f] = CalcRobustMean(std::move(lengths));
  }
  return diameters;
}

std::vector<std::vector<double>> CalcThicknessCosts(
    const TriangleMesh& mesh, const std::vector<double>& diameters,
    int clusters) {
  GRASPDB_EXPECTS(clusters >= 1 && mesh.num_triangles() > 0);
  GRASPDB_EXPECTS(static_cast<int>(diameters.size()) == mesh.num_triangles());
  const std::vector<double> values = ScaleLogarithmically(diameters);
  std::vector<double> areas;
  for (int f = 0; f < mesh.num_triangles(); ++f) areas.push_back(mesh.area(f));
  const std::vector<Component> mixture = FitMixture(values, areas, clusters);
  std::vector<std::vector<double>> costs(
      clusters, std::vector<double>(values.size(), 0.0));
  for (size_t f = 0; f < values.size(); ++f) {
    double sum = kMinDensity;
    for (const Component& c : mixture) sum += c.CalcDensity(values[f]);
    for (int k = 0; k < clusters; ++k) {
      const double density = mixture[k].CalcDensity(values[f]);
      costs[k][f] = -std::log((density + kMinDensity) / (sum + kMinDensity));
    }
  }
  return costs;
}

std::vector<int> SegmentByShapeDiameter(
    const TriangleMesh& mesh, const std::vector<FaceLink>& links, double radius,
    const SegmentationParameters& parameters) {
  const auto costs = CalcThicknessCosts(mesh, CalcShapeDiameters(mesh),
                                        parameters.shape_diameter_clusters);
  return CalcComponents(CutByLabelCosts(mesh, links, costs, radius, parameters),
                        links);
}

}  // namespace graspdb
