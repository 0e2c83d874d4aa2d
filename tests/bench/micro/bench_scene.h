#pragma once

#include <vector>

#include <benchmark/benchmark.h>

#include "engine/geometry/solid.h"
#include "engine/hand/hand_shape.h"
#include "engine/parameters/parameters.h"
#include "engine/planning/grasp.h"

namespace graspdb::bench {

/** What the micro-benchmarks work on: a mug, the Barrett hand, and postures of
 it about the mug, drawn at random once; the same in every run. */
struct Scene {
  HandShape hand;
  Solid solid;
  Parameters parameters;
  std::vector<HandConfiguration> free;       ///< Open, near, no collision.
  std::vector<HandConfiguration> colliding;  ///< Some link does.
  std::vector<Grasp> grasps;                 ///< Stable ones, any number.
};

const Scene& GetScene();

/** Times f(scene, one) over the list, around and around. */
template <class T, class F>
void RunOver(benchmark::State& state, const std::vector<T>& all, const F& f) {
  size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(f(GetScene(), all[i++ % all.size()]));
  }
}

}  // namespace graspdb::bench
