// Values as bytes: blob_codec.cc.
#include <benchmark/benchmark.h>

#include "server/store/blob_codec.h"
#include "tests/bench/micro/bench_scene.h"

namespace graspdb::bench {
namespace {

void EncodingGrasps(benchmark::State& state) {
  RunOver(state, GetScene().grasps, [](const Scene&, const Grasp& one) {
    return EncodeGrasp({one, {}}).size();
  });
}
BENCHMARK(EncodingGrasps);

void DecodingGrasps(benchmark::State& state) {
  std::vector<std::string> blobs;
  for (const Grasp& grasp : GetScene().grasps) {
    blobs.push_back(EncodeGrasp({grasp, {}}));
  }
  RunOver(state, blobs, [](const Scene&, const std::string& bytes) {
    return DecodeGrasp(bytes).has_value();
  });
}
BENCHMARK(DecodingGrasps);

void EncodingAMesh(benchmark::State& state) {
  const TriangleMesh& mesh = GetScene().solid.mesh_O();
  for (auto _ : state) benchmark::DoNotOptimize(EncodeMesh(mesh).size());
}
BENCHMARK(EncodingAMesh)->Unit(benchmark::kMicrosecond);

void DecodingAMesh(benchmark::State& state) {
  const std::string bytes = EncodeMesh(GetScene().solid.mesh_O());
  for (auto _ : state) benchmark::DoNotOptimize(DecodeMesh(bytes).has_value());
}
BENCHMARK(DecodingAMesh)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace graspdb::bench
