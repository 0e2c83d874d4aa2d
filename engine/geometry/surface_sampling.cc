#include "engine/geometry/surface_sampling.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "engine/base/contract.h"
#include "engine/base/random.h"
#include "engine/math/kd_tree.h"

namespace graspdb {
namespace {

// Yuksel's exponent and his limits on the weight of very close pairs.
constexpr int kCandidatesPerSample = 5;
constexpr double kBeta = 0.65;
constexpr double kGamma = 1.5;

struct Rival {
  int index{0};
  double weight{0.0};
};

// For each sample those so near that both cannot be kept, with
// w = (1 - d / 2 r_max)^8.
std::vector<std::vector<Rival>> FindRivals(const SurfaceSamples& samples,
                                           double area, int count) {
  const double max_radius = std::sqrt(area / (2.0 * std::sqrt(3.0) * count));
  const double share = static_cast<double>(count) / samples.size();
  const double min_radius =
      max_radius * kBeta * (1.0 - std::pow(share, kGamma));
  const KdTree tree(samples.points);
  std::vector<std::vector<Rival>> rivals(samples.size());
  for (int i = 0; i < samples.size(); ++i) {
    for (const auto& near :
         tree.FindWithin(samples.points[i], 2.0 * max_radius)) {
      const int j = near.index;
      if (j == i || samples.normals[i].dot(samples.normals[j]) < 0.0) continue;
      const double distance =
          std::max(std::sqrt(near.squared_distance), 2.0 * min_radius);
      const double base = 1.0 - distance / (2.0 * max_radius);
      const double power4 = base * base * base * base;
      rivals[i].push_back({j, power4 * power4});
    }
  }
  return rivals;
}

// Removes the most crowded sample until `count` are left.
std::vector<bool> Eliminate(const std::vector<std::vector<Rival>>& rivals,
                            int count) {
  const int total = static_cast<int>(rivals.size());
  std::vector<bool> kept(total, true);
  std::vector<double> crowding(total, 0.0);
  // Entries whose crowding has changed since are stale and are skipped.
  std::priority_queue<std::pair<double, int>> queue;
  for (int i = 0; i < total; ++i) {
    for (const Rival& rival : rivals[i]) crowding[i] += rival.weight;
    queue.emplace(crowding[i], i);
  }
  for (int remaining = total; remaining > count;) {
    const auto [weight, i] = queue.top();
    queue.pop();
    if (!kept[i] || weight != crowding[i]) continue;
    kept[i] = false;
    --remaining;
    for (const Rival& rival : rivals[i]) {
      if (!kept[rival.index]) continue;
      crowding[rival.index] -= rival.weight;
      queue.emplace(crowding[rival.index], rival.index);
    }
  }
  return kept;
}

}  // namespace

SurfaceSamples SampleSurface(const TriangleMesh& mesh, int count, uint64_t seed,
                             int num_faces) {
  if (num_faces == kAllFaces) num_faces = mesh.num_triangles();
  GRASPDB_EXPECTS(count > 0);
  GRASPDB_EXPECTS(num_faces > 0 && num_faces <= mesh.num_triangles());
  std::vector<double> area_up_to(num_faces);
  double total = 0.0;
  for (int f = 0; f < num_faces; ++f) area_up_to[f] = total += mesh.area(f);
  GRASPDB_EXPECTS(total > 0.0);

  Random random(seed);
  SurfaceSamples samples;
  samples.points.reserve(count);
  samples.normals.reserve(count);
  samples.faces.reserve(count);
  int face = 0;
  for (int i = 0; i < count; ++i) {
    const double area = total * (i + random.NextUniform()) / count;
    // Never a face of zero area: its sum is no greater than its predecessor's.
    while (face + 1 < num_faces && area_up_to[face] <= area) ++face;
    while (mesh.area(face) == 0.0) --face;  // Only rounding at the very end.
    const double root = std::sqrt(random.NextUniform());
    const double v = random.NextUniform();
    samples.points.push_back((1.0 - root) * mesh.corner(face, 0) +
                             root * (1.0 - v) * mesh.corner(face, 1) +
                             root * v * mesh.corner(face, 2));
    samples.normals.push_back(mesh.normal(face));
    samples.faces.push_back(face);
  }
  return samples;
}

SurfaceSamples SamplePoissonDisk(const TriangleMesh& mesh, int count,
                                 uint64_t seed, int num_faces) {
  const SurfaceSamples candidates =
      SampleSurface(mesh, kCandidatesPerSample * count, seed, num_faces);
  double area = 0.0;
  const int end = num_faces == kAllFaces ? mesh.num_triangles() : num_faces;
  for (int f = 0; f < end; ++f) area += mesh.area(f);
  const std::vector<bool> kept =
      Eliminate(FindRivals(candidates, area, count), count);

  SurfaceSamples samples;
  for (int i = 0; i < candidates.size(); ++i) {
    if (!kept[i]) continue;
    samples.points.push_back(candidates.points[i]);
    samples.normals.push_back(candidates.normals[i]);
    samples.faces.push_back(candidates.faces[i]);
  }
  return samples;
}

}  // namespace graspdb
