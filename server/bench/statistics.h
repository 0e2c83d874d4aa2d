#pragma once

#include <vector>

namespace graspdb {

/** `hits` of `count`, and where its true share probably lies. */
struct Proportion {
  int hits{0};
  int count{0};
  double lower{0.0};  ///< Of the 95 % interval, 0..1 …
  double upper{1.0};  ///< … both ends.

  double share() const { return count > 0 ? 1.0 * hits / count : 0.0; }
};

/** With Wilson's score interval at 95 % [Wilson 1927]; 0..1 when count is 0.
 @pre 0 <= hits <= count. */
Proportion CalcProportion(int hits, int count);

/** The value below which a share q of them lies, interpolated between ranks; 0
 for none. @pre 0 <= q <= 1. */
double CalcQuantile(std::vector<double> values, double q);

}  // namespace graspdb
