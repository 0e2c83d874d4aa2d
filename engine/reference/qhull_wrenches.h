#pragma once

#include "engine/quality/wrench_space.h"

namespace graspdb {

/** Signed distance of the origin to the nearest hull facet's plane, by qhull:
 positive when the origin is inside. Minus infinity for a flat hull. */
double CalcEpsilonByQhull(const Wrenches& wrenches);

/** The hull's volume by qhull; 0 for a flat one. */
double CalcVolumeByQhull(const Wrenches& wrenches);

}  // namespace graspdb
