#include "engine/planning/start_yield.h"

namespace graspdb {

double CalcYield(const StartYield& yield, double expected) {
  return (yield.gains + 1.0) / (yield.tries + 1.0 / expected);
}

std::optional<size_t> DrawByYield(const std::vector<double>& yields,
                                  double elsewhere, Random& random) {
  double sum = elsewhere;
  for (const double yield : yields) sum += yield;
  double left = sum * random.NextUniform();
  for (size_t i = 0; i < yields.size(); ++i) {
    if (left < yields[i]) return i;
    left -= yields[i];
  }
  return std::nullopt;
}

}  // namespace graspdb
