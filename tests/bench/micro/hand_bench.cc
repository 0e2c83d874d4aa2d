// Forward kinematics and collision: hand_model.cc, hand_shape.cc.
#include <benchmark/benchmark.h>

#include "engine/hand/hand_shape.h"
#include "tests/bench/micro/bench_scene.h"

namespace graspdb::bench {
namespace {

void ForwardKinematics(benchmark::State& state) {
  const Scene& scene = GetScene();
  size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        CalcLinkPoses(scene.hand.model(), Next(scene.free, i).q));
  }
}
BENCHMARK(ForwardKinematics);

template <class Test>
void RunCollision(benchmark::State& state,
                  const std::vector<HandConfiguration>& postures,
                  const Test& test) {
  const Scene& scene = GetScene();
  size_t i = 0;
  for (auto _ : state) {
    const HandConfiguration& posture = Next(postures, i);
    benchmark::DoNotOptimize(test(scene.hand, posture.X_OH,
                                  CalcLinkPoses(scene.hand.model(), posture.q),
                                  scene.solid));
  }
}

void ExactCollisionWhenFree(benchmark::State& state) {
  RunCollision(state, GetScene().free, FindCollidingLink);
}
BENCHMARK(ExactCollisionWhenFree);

void ExactCollisionWhenColliding(benchmark::State& state) {
  RunCollision(state, GetScene().colliding, FindCollidingLink);
}
BENCHMARK(ExactCollisionWhenColliding);

void EstimatedCollisionWhenFree(benchmark::State& state) {
  RunCollision(state, GetScene().free, EstimateCollidingLink);
}
BENCHMARK(EstimatedCollisionWhenFree);

void SelfCollisionWhenOpen(benchmark::State& state) {
  RunCollision(state, GetScene().free,
               [](const HandShape& hand, const RigidTransform&,
                  const std::vector<RigidTransform>& X_HL,
                  const Solid&) { return FindSelfCollision(hand, X_HL); });
}
BENCHMARK(SelfCollisionWhenOpen);

void SelfCollisionWhenClosed(benchmark::State& state) {
  const Scene& scene = GetScene();
  size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(FindSelfCollision(
        scene.hand, CalcLinkPoses(scene.hand.model(),
                                  Next(scene.grasps, i).configuration.q)));
  }
}
BENCHMARK(SelfCollisionWhenClosed);

}  // namespace
}  // namespace graspdb::bench
