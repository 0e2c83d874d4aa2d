// The pieces of active learning: configuration_space.cc, svm.cc.
#include <benchmark/benchmark.h>

#include "engine/base/random.h"
#include "engine/cspace/configuration_space.h"
#include "engine/cspace/svm.h"
#include "tests/bench/micro/bench_scene.h"

namespace graspdb::bench {
namespace {

constexpr double kPenalty = 10.0;
constexpr double kGamma = 1.0;

struct Labelled {
  explicit Labelled(int count)
      : space(GetScene().hand, GetScene().solid), features() {
    Random random(3);
    for (int i = 0; i < count; ++i) {
      postures.push_back(space.Sample(random));
      const Eigen::VectorXd column = space.CalcFeatures(postures.back());
      if (i == 0) features.resize(column.size(), count);
      features.col(i) = column;
      labels.push_back(space.Collides(postures.back()));
    }
  }

  ConfigurationSpace space;
  std::vector<HandPosture> postures;
  Eigen::MatrixXd features;  // One column per posture.
  std::vector<bool> labels;
};

void Labels(benchmark::State& state) {
  const Labelled drawn(1000);
  RunOver(state, drawn.postures, [&](const Scene&, const HandPosture& one) {
    return drawn.space.Collides(one);
  });
}
BENCHMARK(Labels);

void Training(benchmark::State& state) {
  const Labelled drawn(static_cast<int>(state.range(0)));
  size_t vectors = 0;
  for (auto _ : state) {
    const Svm svm(drawn.features, drawn.labels, kPenalty, kGamma);
    vectors = svm.support_vectors().size();
  }
  state.counters["support_vectors"] = static_cast<double>(vectors);
}
BENCHMARK(Training)->Arg(1000)->Arg(4000)->Unit(benchmark::kMillisecond);

void Deciding(benchmark::State& state) {
  const Labelled drawn(2000);
  const Svm svm(drawn.features, drawn.labels, kPenalty, kGamma);
  int i = 0;
  for (auto _ : state) {
    const Eigen::VectorXd one = drawn.features.col(i++ % 2000);
    benchmark::DoNotOptimize(svm.CalcDecisionValue(one));
  }
}
BENCHMARK(Deciding);

}  // namespace
}  // namespace graspdb::bench
