#pragma once

#include <string>

#include "engine/geometry/mesh_reader.h"
#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** The mesh as a file, metres: OBJ text (coordinates that read back to the same
 doubles), binary STL (single precision), binary PLY (doubles). */
std::string WriteMesh(const TriangleMesh& mesh, MeshFormat format);

}  // namespace graspdb
