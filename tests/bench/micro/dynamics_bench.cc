// A hand that closes on a floating object: closing_simulation.cc,
// touch_finder.cc.
#include <benchmark/benchmark.h>

#include "engine/dynamics/closing_simulation.h"
#include "tests/bench/micro/bench_scene.h"

namespace graspdb::bench {
namespace {

void SimulatedClosing(benchmark::State& state, Push push) {
  const Scene& scene = GetScene();
  const ClosingSimulation simulation(
      scene.hand, scene.solid, scene.parameters.hold, scene.parameters.motors);
  RunOver(state, scene.grasps, [&](const Scene&, const Grasp& one) {
    return simulation.Run(one.configuration.X_OH, one.q_pregrasp,
                          scene.parameters.contact.friction, push);
  });
}
BENCHMARK_CAPTURE(SimulatedClosing, alone, Push::kNone);
BENCHMARK_CAPTURE(SimulatedClosing, and_push, Push::kPlusX);

}  // namespace
}  // namespace graspdb::bench
