#include "engine/planning/start_yield.h"

namespace graspdb {
namespace {

constexpr int kExpectedTries = 100;  // Per gain.
constexpr double kYieldElsewhere = 0.005;

}  // namespace

double CalcYield(const StartYield& yield) {
  return (yield.gains + 1.0) / (yield.tries + kExpectedTries);
}

std::optional<size_t> DrawByYield(const std::vector<double>& yields,
                                  Random& random) {
  double sum = kYieldElsewhere;
  for (const double yield : yields) sum += yield;
  double left = sum * random.NextUniform();
  for (size_t i = 0; i < yields.size(); ++i) {
    if (left < yields[i]) return i;
    left -= yields[i];
  }
  return std::nullopt;
}

}  // namespace graspdb
