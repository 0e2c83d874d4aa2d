#pragma once

#include <array>

#include "engine/geometry/surface_samples.h"

namespace graspdb {

/** How a shape's points lie apart: a histogram of the distances of random pairs
 of surface points over their mean (D2 of Osada et al. 2002), shares that sum to
 1. Does not depend on pose, unit or triangulation. */
using ShapeDescriptor = std::array<double, 48>;

/** @param samples  Uniform over the surface. @pre At least 2, not all alike. */
ShapeDescriptor CalcShapeDescriptor(const SurfaceSamples& samples);

/** How much of the one histogram has to move, times how far in bins, to make
 the other: the earth mover's distance in one dimension. */
double CalcDescriptorDistance(const ShapeDescriptor& a,
                              const ShapeDescriptor& b);

}  // namespace graspdb
