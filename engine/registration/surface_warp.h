#pragma once

#include "engine/geometry/surface_samples.h"
#include "engine/parameters/transfer_parameters.h"
#include "engine/registration/sample_matching.h"

namespace graspdb {

/** The samples of E where an affine map puts them on N. */
SurfaceSamples MapSamples(const SurfaceSamples& samples_E,
                          const AffineMap& map_NE);

/** Bends samples that lie roughly on N's surface until they lie on it: nearest
 neighbours in both directions by position and normal pull at every sample, the
 pulls are smoothed by a bell-shaped kernel that narrows from step to step, and
 normals turn with the bending. Finds what no affine map can, such as a taper or
 a belly. Deterministic.
 @param samples_E  In frame N already; metres.
 @param parameters  Its warp_steps, widths and normal_weight.
 @pre Both have at least 4 samples. */
SurfaceSamples WarpSamples(const SurfaceSamples& samples_E,
                           const SurfaceSamples& samples_N,
                           const MappingParameters& parameters);

}  // namespace graspdb
