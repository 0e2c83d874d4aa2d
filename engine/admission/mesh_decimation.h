#pragma once

#include "engine/base/result.h"
#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** A mesh with at most max_triangles faces, as far as the topology permits, by
 collapsing edges (Lindstrom and Turk 1998), which keeps the volume, above
 100,000 faces after merging the shortest edges; the very same mesh when it has
 no more than max_triangles. The result is closed; where collapsing makes it
 cross itself it is repaired, as far as RepairMesh() can.
 @pre The mesh is the closed manifold that RepairMesh() returns;
   max_triangles >= 4.
 @retval kInternal if the collapse breaks the mesh. */
Result<TriangleMesh> Decimate(const TriangleMesh& mesh, int max_triangles);

}  // namespace graspdb
