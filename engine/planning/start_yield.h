#pragma once

#include <optional>
#include <vector>

#include "engine/base/random.h"

namespace graspdb {

/** What particles that started near the grasps of one approach came to. */
struct StartYield {
  int tries{0};  ///< Iterations of theirs.
  int gains{0};  ///< New grasps, of whatever approach.
};

/** New grasps per try, where one in 100 is expected until something is known:
 (gains + 1) / (tries + 100). */
double CalcYield(const StartYield& yield);

/** Draws an index in proportion to what each yields.
 @param yields  As by CalcYield().
 @returns nullopt, to start elsewhere, as if that yielded 0.005 in the long run:
 always when there are none, and nearly always when all are exhausted. */
std::optional<size_t> DrawByYield(const std::vector<double>& yields,
                                  Random& random);

}  // namespace graspdb
