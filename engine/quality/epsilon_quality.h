#pragma once

#include "engine/quality/wrench_space.h"

namespace graspdb {

/** The Ferrari-Canny quality ε: the radius of the largest ball about the origin
 within the convex hull of the wrenches (L1). When the origin lies outside, the
 negative of a lower bound of its distance to the hull, so that a search has a
 slope to follow; -1 when the wrenches do not span six dimensions.
 An expanding polytope in 6-D that opens only the facets nearest to the origin;
 exact to 1e-9. @paper{Sec. IV, ε of Eq. (1)} [Ferrari and Canny 1992] */
double CalcEpsilonQuality(const Wrenches& wrenches);

/** The volume of the convex hull of the wrenches; 0 when they do not span six
 dimensions or rounding defeats it. */
double CalcWrenchVolume(const Wrenches& wrenches);

}  // namespace graspdb
