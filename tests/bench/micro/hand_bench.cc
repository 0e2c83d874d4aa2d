// Forward kinematics and collision: hand_model.cc, hand_shape.cc.
#include <benchmark/benchmark.h>

#include "engine/hand/hand_shape.h"
#include "tests/bench/micro/bench_scene.h"

namespace graspdb::bench {
namespace {

void ForwardKinematics(benchmark::State& state) {
  RunOver(state, GetScene().free,
          [](const Scene& scene, const HandConfiguration& one) {
            return CalcLinkPoses(scene.hand.model(), one.q);
          });
}
BENCHMARK(ForwardKinematics);

using CollisionTest = int (*)(const HandShape&, const RigidTransform&,
                              const std::vector<RigidTransform>&, const Solid&);

void Collision(benchmark::State& state, CollisionTest test,
               const std::vector<HandConfiguration> Scene::*postures) {
  RunOver(state, GetScene().*postures,
          [test](const Scene& scene, const HandConfiguration& one) {
            return test(scene.hand, one.X_OH,
                        CalcLinkPoses(scene.hand.model(), one.q), scene.solid);
          });
}
BENCHMARK_CAPTURE(Collision, exact_free, FindCollidingLink, &Scene::free);
BENCHMARK_CAPTURE(Collision, exact_colliding, FindCollidingLink,
                  &Scene::colliding);
BENCHMARK_CAPTURE(Collision, estimated_free, EstimateCollidingLink,
                  &Scene::free);

void SelfCollisionWhenOpen(benchmark::State& state) {
  RunOver(state, GetScene().free,
          [](const Scene& scene, const HandConfiguration& one) {
            return FindSelfCollision(scene.hand,
                                     CalcLinkPoses(scene.hand.model(), one.q));
          });
}
BENCHMARK(SelfCollisionWhenOpen);

void SelfCollisionWhenClosed(benchmark::State& state) {
  RunOver(state, GetScene().grasps, [](const Scene& scene, const Grasp& one) {
    return FindSelfCollision(
        scene.hand, CalcLinkPoses(scene.hand.model(), one.configuration.q));
  });
}
BENCHMARK(SelfCollisionWhenClosed);

}  // namespace
}  // namespace graspdb::bench
