#pragma once

#include <vector>

#include <benchmark/benchmark.h>

#include "server/bench/speed/speed_scene.h"

namespace graspdb::bench {

/** What the micro-benchmarks work on: a mug and the Barrett hand. */
using Scene = SpeedScene;

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
