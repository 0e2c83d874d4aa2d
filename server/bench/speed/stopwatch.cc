#include "server/bench/speed/stopwatch.h"

#include "server/bench/statistics.h"

namespace graspdb {

double CalcMedian(const Timing& timing) {
  return CalcQuantile(timing.samples, 0.5);
}

Json EncodeTiming(const Timing& timing) {
  return {{"median", CalcMedian(timing)},
          {"lower", CalcQuantile(timing.samples, 0.25)},
          {"upper", CalcQuantile(timing.samples, 0.75)},
          {"samples", timing.samples.size()},
          {"calls", timing.calls}};
}

}  // namespace graspdb
