#pragma once

#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** Cuts every edge in the middle and every triangle into four: those of face f
 become faces 4f to 4f + 3. The surface stays the same. */
TriangleMesh Subdivide(const TriangleMesh& mesh);

}  // namespace graspdb
