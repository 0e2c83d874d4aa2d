// What a closed grasp is worth: contact_extraction.cc, epsilon_quality.cc,
// grip_balance.cc, hybrid_measure.cc.
#include <benchmark/benchmark.h>

#include "engine/planning/grasp_evaluator.h"
#include "engine/quality/contact_extraction.h"
#include "engine/quality/epsilon_quality.h"
#include "tests/bench/micro/bench_scene.h"

namespace graspdb::bench {
namespace {

void ContactExtraction(benchmark::State& state) {
  RunOver(state, GetScene().grasps, [](const Scene& scene, const Grasp& one) {
    return ExtractContacts(
        scene.hand, one.configuration.X_OH,
        CalcLinkPoses(scene.hand.model(), one.configuration.q), scene.solid,
        scene.parameters.contact);
  });
}
BENCHMARK(ContactExtraction);

// Of all contacts of real grasps.
void EpsilonOfGrasps(benchmark::State& state) {
  double contacts = 0.0;
  RunOver(state, GetScene().grasps, [&](const Scene& scene, const Grasp& one) {
    contacts += static_cast<double>(one.contacts.size());
    return CalcEpsilon(one.contacts, scene.solid.mass(),
                       scene.parameters.contact);
  });
  state.counters["contacts"] =
      benchmark::Counter(contacts, benchmark::Counter::kAvgIterations);
}
BENCHMARK(EpsilonOfGrasps);

// Of so many of their contacts, evenly taken.
void EpsilonOfContacts(benchmark::State& state) {
  const Scene& scene = GetScene();
  const auto count = static_cast<size_t>(state.range(0));
  std::vector<Wrenches> all;
  for (const Grasp& grasp : scene.grasps) {
    if (grasp.contacts.size() < count) continue;
    std::vector<Contact> some;
    for (size_t k = 0; k < count; ++k) {
      some.push_back(grasp.contacts[k * grasp.contacts.size() / count]);
    }
    all.push_back(CalcContactWrenches(some, scene.solid.mass(),
                                      scene.parameters.contact));
  }
  RunOver(state, all, [](const Scene&, const Wrenches& wrenches) {
    return CalcEpsilonQuality(wrenches);
  });
}
BENCHMARK(EpsilonOfContacts)->DenseRange(3, 7);

void HybridMeasure(benchmark::State& state) {
  RunOver(state, GetScene().grasps, [](const Scene& scene, const Grasp& one) {
    return CalcHybrid(scene.hand, one, scene.solid, scene.parameters);
  });
}
BENCHMARK(HybridMeasure);

void GripResidual(benchmark::State& state) {
  RunOver(state, GetScene().grasps, [](const Scene& scene, const Grasp& one) {
    return CalcGrip(scene.hand, one, scene.solid.mass(), scene.parameters);
  });
}
BENCHMARK(GripResidual);

}  // namespace
}  // namespace graspdb::bench
