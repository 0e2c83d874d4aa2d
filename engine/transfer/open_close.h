#pragma once

#include "engine/geometry/solid.h"
#include "engine/hand/hand_shape.h"
#include "engine/parameters/parameters.h"
#include "engine/transfer/local_replanner.h"

namespace graspdb {

/** The open-close baseline: at T* X_EH the colliding fingers are straightened,
 then all close; no replanning. ε, or 0 when it is not stable.
 @paper{Sec. VI-C, baseline} [Krug et al. 2014] */
double CalcOpenCloseEpsilon(const HandShape& hand, const TransferTask& task,
                            const Solid& solid, const Parameters& parameters);

}  // namespace graspdb
