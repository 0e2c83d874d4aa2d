#pragma once

#include <cstddef>

#include "engine/admission/soup_cleaning.h"

namespace graspdb {

/** A wrap of more points is begun anew, three times as coarse. An object of
 thin walls takes up to 12,400; a few spikes that cross each other in a box of
 their own size would take 35,000, and 20 s. */
inline constexpr std::size_t kMostWrapPoints = 13'000;

/** A closed surface about any triangles (alpha wrap: Portaneri et al. 2022),
 moved back to where they lie unless it would cross itself there. Nothing
 narrower than 1/75 of the diagonal is entered, and the surface lies within
 about 1/1000 of it; three times as much, again and again, while the wrap would
 take too many points.
 @param diagonal  Of the object's box, m.
 @param most_points  At least 1,000: the coarsest wrap takes some, too. */
TriangleSoup WrapSurface(const TriangleSoup& soup, double diagonal,
                         std::size_t most_points, RepairLog& log);

}  // namespace graspdb
