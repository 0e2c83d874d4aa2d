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

/** New grasps per try: (gains + 1) / (tries + 1 / expected).
 @param expected  What it is held for until something is known, (0, 1]. */
double CalcYield(const StartYield& yield, double expected);

/** Draws an index in proportion to what each yields.
 @param yields  As by CalcYield().
 @param elsewhere  What starting elsewhere is held to yield, > 0.
 @returns nullopt, to start elsewhere: always when there are no yields, and
 nearly always when all are exhausted. */
std::optional<size_t> DrawByYield(const std::vector<double>& yields,
                                  double elsewhere, Random& random);

}  // namespace graspdb
