#include "server/bench/statistics.h"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.h"

namespace graspdb {

Proportion CalcProportion(int hits, int count) {
  GRASPDB_EXPECTS(0 <= hits && hits <= count);
  Proportion result{hits, count};
  if (count == 0) return result;
  constexpr double kZ = 1.959963984540054;  // Of 95 %.
  const double n = count;
  const double p = hits / n;
  const double z2 = kZ * kZ;
  const double middle = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double half =
      kZ / (1.0 + z2 / n) * std::sqrt(p * (1.0 - p) / n + z2 / (4.0 * n * n));
  result.lower = std::max(0.0, middle - half);
  result.upper = std::min(1.0, middle + half);
  return result;
}

double CalcQuantile(std::vector<double> values, double q) {
  GRASPDB_EXPECTS(0.0 <= q && q <= 1.0);
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double rank = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<size_t>(rank);
  const size_t above = std::min(below + 1, values.size() - 1);
  const double share = rank - static_cast<double>(below);
  return (1.0 - share) * values[below] + share * values[above];
}

}  // namespace graspdb
