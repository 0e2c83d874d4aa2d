#include "engine/registration/shape_descriptor.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/contract.h"
#include "engine/base/random.h"

namespace graspdb {
namespace {

constexpr double kLongest = 3.0;  // Mean distances that the histogram covers.
constexpr size_t kPairs = 50'000;

}  // namespace

ShapeDescriptor CalcShapeDescriptor(const SurfaceSamples& samples) {
  const int count = samples.size();
  GRASPDB_EXPECTS(count >= 2);
  Random random(1);
  std::vector<double> distances;
  double sum = 0.0;
  while (distances.size() < kPairs) {
    const int i = random.NextIndex(count);
    const int j = random.NextIndex(count);
    if (i == j) continue;
    distances.push_back((samples.points[i] - samples.points[j]).norm());
    sum += distances.back();
  }
  GRASPDB_EXPECTS(sum > 0.0);
  const double mean = sum / static_cast<double>(distances.size());
  ShapeDescriptor histogram{};
  const auto bins = static_cast<double>(histogram.size());
  for (const double d : distances) {
    const double bin = std::min(bins - 1.0, d / mean * bins / kLongest);
    histogram[static_cast<size_t>(bin)] +=
        1.0 / static_cast<double>(distances.size());
  }
  return histogram;
}

double CalcDescriptorDistance(const ShapeDescriptor& a,
                              const ShapeDescriptor& b) {
  double carried = 0.0, work = 0.0;
  for (size_t i = 0; i < a.size(); ++i) {
    carried += a[i] - b[i];
    work += std::abs(carried);
  }
  return work;
}

}  // namespace graspdb
