#pragma once

#include <string>

#include "engine/admission/mesh_format.h"
#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** The mesh as a file, metres: OBJ text (coordinates that read back to the same
 doubles), binary STL (single precision), binary PLY (doubles), GLB (single
 precision, no material, z up as the file that came in).
 @pre The format is one of these. */
std::string WriteMesh(const TriangleMesh& mesh, MeshFormat format);

}  // namespace graspdb
