// From one object to another: surface_alignment.cc, surface_warp.cc,
// contact_map.cc, label_transfer.cc, local_replanner.cc.
#include <cmath>

#include <benchmark/benchmark.h>

#include "engine/geometry/surface_sampling.h"
#include "engine/registration/surface_alignment.h"
#include "engine/registration/surface_warp.h"
#include "engine/segmentation/label_transfer.h"
#include "engine/transfer/contact_map.h"
#include "engine/transfer/local_replanner.h"
#include "tests/bench/micro/bench_scene.h"
#include "tests/support/workshop.h"

namespace graspdb::bench {
namespace {

// An example mug and another one, laid over each other.
struct Pair {
  LabelledMesh example{workshop::LoadMug("classic")};
  TriangleMesh novel{workshop::LoadMug("latte").mesh_O};
  MappingParameters mapping;
  SurfaceSamples samples_E{
      SamplePoissonDisk(example.mesh_O, mapping.samples, 1)};
  SurfaceSamples samples_N{SamplePoissonDisk(novel, mapping.samples, 2)};
  SurfaceAlignment alignment{AlignSurfaces(samples_E, samples_N, {})};
  SurfaceSamples mapped{MapSamples(samples_E, alignment.map_NE)};
};

const Pair& GetPair() {
  static const Pair pair;
  return pair;
}

void Sampling(benchmark::State& state) {
  const Pair& pair = GetPair();
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        SamplePoissonDisk(pair.novel, pair.mapping.samples, 1).size());
  }
}
BENCHMARK(Sampling)->Unit(benchmark::kMillisecond);

void AlignmentFromManyStarts(benchmark::State& state) {
  const Pair& pair = GetPair();
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        AlignSurfaces(pair.samples_E, pair.samples_N, {}).residual);
  }
}
BENCHMARK(AlignmentFromManyStarts)->Unit(benchmark::kMillisecond);

void AlignmentFromANearStart(benchmark::State& state) {
  const Pair& pair = GetPair();
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        RefineAlignment(pair.samples_E, pair.samples_N, pair.alignment, {})
            .residual);
  }
}
BENCHMARK(AlignmentFromANearStart)->Unit(benchmark::kMillisecond);

void Warp(benchmark::State& state) {
  const Pair& pair = GetPair();
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        WarpSamples(pair.mapped, pair.samples_N, pair.mapping).size());
  }
}
BENCHMARK(Warp)->Unit(benchmark::kMillisecond);

void MappingContacts(benchmark::State& state) {
  const Pair& pair = GetPair();
  const SurfaceIndex index_E(pair.example.mesh_O);
  const SurfaceIndex index_N(pair.novel);
  for (auto _ : state) {
    benchmark::DoNotOptimize(ContactMap(pair.samples_E, pair.samples_N,
                                        pair.mapped, index_E, index_N,
                                        pair.mapping)
                                 .CalcMappedShare());
  }
}
BENCHMARK(MappingContacts)->Unit(benchmark::kMillisecond);

void LabelTransfer(benchmark::State& state) {
  const Pair& pair = GetPair();
  const SegmentationParameters parameters;
  constexpr int kLabels = 2;
  std::vector<int> labels;
  for (const int face : pair.samples_E.faces) {
    labels.push_back(pair.example.face_labels[static_cast<size_t>(face)]);
  }
  double square = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : pair.samples_N.points) mean += p;
  mean /= pair.samples_N.size();
  for (const auto& p : pair.samples_N.points)
    square += (p - mean).squaredNorm();
  const double radius = std::sqrt(square / pair.samples_N.size());
  const auto links = CalcFaceLinks(pair.novel);
  for (auto _ : state) {
    const auto costs =
        CalcLabelCosts(pair.novel, pair.samples_E, labels, kLabels,
                       pair.alignment.map_NE, radius, parameters);
    benchmark::DoNotOptimize(
        CutByLabelCosts(pair.novel, links, costs, radius, parameters));
  }
}
BENCHMARK(LabelTransfer)->Unit(benchmark::kMillisecond);

// Each stable grasp, begun 3 mm beside itself.
void Replanning(benchmark::State& state) {
  std::vector<TransferTask> tasks;
  for (const Grasp& grasp : GetScene().grasps) {
    TransferTask task;
    task.X_NH = grasp.configuration.X_OH;
    task.X_NH.translation.x() += 0.003;
    task.q_pregrasp = grasp.q_pregrasp;
    task.q = grasp.configuration.q;
    const auto X_HL =
        CalcLinkPoses(GetScene().hand.model(), grasp.configuration.q);
    for (const Contact& contact : grasp.contacts) {
      const RigidTransform X_OL =
          grasp.configuration.X_OH * X_HL[static_cast<size_t>(contact.link)];
      const Eigen::Vector3d p_L = X_OL.Inverse() * contact.p_O;
      task.targets.push_back({contact.link, p_L,
                              -X_OL.rotation.transpose() * contact.nhat_O,
                              contact.p_O, contact.nhat_O});
    }
    tasks.push_back(std::move(task));
  }
  RunOver(state, tasks, [](const Scene& scene, const TransferTask& task) {
    return Replan(scene.hand, task, scene.solid, scene.parameters, 1).outcome;
  });
}
BENCHMARK(Replanning)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace graspdb::bench
