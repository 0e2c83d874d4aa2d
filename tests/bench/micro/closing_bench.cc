// Closing the fingers: finger_closing.cc, grasp_evaluator.cc.
#include <benchmark/benchmark.h>

#include "engine/hand/finger_closing.h"
#include "engine/planning/grasp_evaluator.h"
#include "tests/bench/micro/bench_scene.h"

namespace graspdb::bench {
namespace {

void Closing(benchmark::State& state, Precision precision) {
  RunOver(state, GetScene().grasps, [&](const Scene& scene, const Grasp& one) {
    return CloseFingers(scene.hand, one.configuration.X_OH, one.q_pregrasp,
                        scene.solid, precision);
  });
}
BENCHMARK_CAPTURE(Closing, estimated, Precision::kEstimated);
BENCHMARK_CAPTURE(Closing, exact, Precision::kExact);

void Judging(benchmark::State& state, Precision precision) {
  RunOver(state, GetScene().grasps, [&](const Scene& scene, const Grasp& one) {
    return CloseAndJudge(scene.hand, one.configuration.X_OH, one.q_pregrasp,
                         scene.solid, scene.parameters, precision);
  });
}
BENCHMARK_CAPTURE(Judging, estimated, Precision::kEstimated);
BENCHMARK_CAPTURE(Judging, exact, Precision::kExact);

void TimingFingers(benchmark::State& state) {
  RunOver(state, GetScene().grasps, [](const Scene& scene, const Grasp& one) {
    return TimeFingers(scene.hand, one, scene.solid, scene.parameters);
  });
}
BENCHMARK(TimingFingers);

}  // namespace
}  // namespace graspdb::bench
