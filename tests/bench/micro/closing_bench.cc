// Closing the fingers: finger_closing.cc, grasp_evaluator.cc.
#include <benchmark/benchmark.h>

#include "engine/hand/finger_closing.h"
#include "engine/planning/grasp_evaluator.h"
#include "tests/bench/micro/bench_scene.h"

namespace graspdb::bench {
namespace {

void RunClosing(benchmark::State& state, Precision precision) {
  const Scene& scene = GetScene();
  size_t i = 0;
  for (auto _ : state) {
    const Grasp& grasp = Next(scene.grasps, i);
    benchmark::DoNotOptimize(CloseFingers(scene.hand, grasp.configuration.X_OH,
                                          grasp.q_pregrasp, scene.solid,
                                          precision));
  }
}

void EstimatedClosing(benchmark::State& state) {
  RunClosing(state, Precision::kEstimated);
}
BENCHMARK(EstimatedClosing);

void ExactClosing(benchmark::State& state) {
  RunClosing(state, Precision::kExact);
}
BENCHMARK(ExactClosing);

void RunJudging(benchmark::State& state, Precision precision) {
  const Scene& scene = GetScene();
  size_t i = 0;
  for (auto _ : state) {
    const Grasp& grasp = Next(scene.grasps, i);
    benchmark::DoNotOptimize(CloseAndJudge(scene.hand, grasp.configuration.X_OH,
                                           grasp.q_pregrasp, scene.solid,
                                           scene.parameters, precision));
  }
}

void EstimatedJudging(benchmark::State& state) {
  RunJudging(state, Precision::kEstimated);
}
BENCHMARK(EstimatedJudging);

void ExactJudging(benchmark::State& state) {
  RunJudging(state, Precision::kExact);
}
BENCHMARK(ExactJudging);

void TimingFingers(benchmark::State& state) {
  const Scene& scene = GetScene();
  size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(TimeFingers(scene.hand, Next(scene.grasps, i),
                                         scene.solid, scene.parameters));
  }
}
BENCHMARK(TimingFingers);

}  // namespace
}  // namespace graspdb::bench
