#pragma once

#include <cstdint>

#include "engine/geometry/surface_samples.h"
#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** Samples every face of a mesh. */
inline constexpr int kAllFaces = -1;

/** `count` points uniform in area, one in each of `count` strata of equal area,
 in face order. Deterministic for a seed; the same barycentric coordinates
 whatever the mesh's pose and scale.
 @param num_faces  Only the first so many faces: leaves out a part's caps.
 @pre count > 0 and the faces have a positive area. */
SurfaceSamples SampleSurface(const TriangleMesh& mesh, int count, uint64_t seed,
                             int num_faces = kAllFaces);

/** Exactly `count` points with blue-noise spacing, in face order: five times as
 many area-uniform points are thinned by weighted sample elimination (Yuksel
 2015). Points whose normals oppose each other do not compete, so that the two
 sides of a thin wall are covered independently.
 Deterministic, and the arguments as for SampleSurface(). */
SurfaceSamples SamplePoissonDisk(const TriangleMesh& mesh, int count,
                                 uint64_t seed, int num_faces = kAllFaces);

}  // namespace graspdb
