// Distances: distance_field.cc, surface_index.cc.
#include <benchmark/benchmark.h>

#include "engine/base/random.h"
#include "tests/bench/micro/bench_scene.h"

namespace graspdb::bench {
namespace {

// Within 20 mm of the mug's box.
std::vector<Eigen::Vector3d> DrawPoints() {
  const TriangleMesh& mesh = GetScene().solid.mesh_O();
  Random random(2);
  std::vector<Eigen::Vector3d> points(1024);
  for (Eigen::Vector3d& p : points) {
    for (int k = 0; k < 3; ++k) {
      p[k] = random.NextUniform(mesh.box_min()[k] - 0.02,
                                mesh.box_max()[k] + 0.02);
    }
  }
  return points;
}

void FieldDistance(benchmark::State& state) {
  const DistanceField& field = GetScene().solid.field();
  RunOver(state, DrawPoints(), [&](const Scene&, const Eigen::Vector3d& p) {
    return field.Calc(p);
  });
}
BENCHMARK(FieldDistance);

void ClosestPointOnTheSurface(benchmark::State& state) {
  const SurfaceIndex& index = GetScene().solid.index();
  RunOver(state, DrawPoints(), [&](const Scene&, const Eigen::Vector3d& p) {
    return index.FindClosest(p);
  });
}
BENCHMARK(ClosestPointOnTheSurface);

void MakingASolid(benchmark::State& state) {
  const TriangleMesh& mesh = GetScene().solid.mesh_O();
  for (auto _ : state) benchmark::DoNotOptimize(Solid(mesh).mass().volume);
}
BENCHMARK(MakingASolid)->Unit(benchmark::kMillisecond);

void MakingAHand(benchmark::State& state) {
  const auto model = std::make_shared<const HandModel>(GetScene().hand.model());
  for (auto _ : state) benchmark::DoNotOptimize(HandShape(model).reach(0));
}
BENCHMARK(MakingAHand)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace graspdb::bench
