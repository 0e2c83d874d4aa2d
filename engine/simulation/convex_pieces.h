#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** A solid's surface as convex pieces, for simulators that collide nothing
 else: each the hull of its points, a patch of the surface made as thick as the
 solid is there, at most `depth`. Together they cover the surface; a hull stands
 out of the solid by little more than `concavity`, so handles stay open and cups
 hollow. What lies deeper than `depth` stays empty.
 @param mesh_O  Closed. @param concavity, depth  m, positive.
 @returns Points in the mesh's frame, m. Deterministic. */
std::vector<std::vector<Eigen::Vector3d>> MakeConvexPieces(
    const TriangleMesh& mesh_O, double concavity = 0.001, double depth = 0.01);

}  // namespace graspdb
