// A hand that closes on a floating object: closing_simulation.cc,
// touch_finder.cc.
#include <benchmark/benchmark.h>

#include "engine/dynamics/closing_simulation.h"
#include "tests/bench/micro/bench_scene.h"

namespace graspdb::bench {
namespace {

void RunSimulation(benchmark::State& state, Push push) {
  const Scene& scene = GetScene();
  const ClosingSimulation simulation(
      scene.hand, scene.solid, scene.parameters.hold, scene.parameters.motors);
  size_t i = 0;
  for (auto _ : state) {
    const Grasp& grasp = Next(scene.grasps, i);
    benchmark::DoNotOptimize(
        simulation.Run(grasp.configuration.X_OH, grasp.q_pregrasp,
                       scene.parameters.contact.friction, push));
  }
}

void SimulatedClosing(benchmark::State& state) {
  RunSimulation(state, Push::kNone);
}
BENCHMARK(SimulatedClosing);

void SimulatedClosingAndPush(benchmark::State& state) {
  RunSimulation(state, Push::kPlusX);
}
BENCHMARK(SimulatedClosingAndPush);

}  // namespace
}  // namespace graspdb::bench
