#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "engine/admission/mesh_format.h"
#include "engine/base/result.h"
#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** Decodes a triangle soup as the file has it: faces in the file's order,
 polygons triangulated in place; the vertices that faces use, in the file's
 order; coordinates in single precision times metres_per_unit. Of a scene (GLB,
 glTF, DAE) every node's meshes where its transforms put them, whatever axis
 points up. A file without vertices of its own (STL, scenes): corners at exactly
 the same position share one, in the order of first mention. Nothing else is
 welded or repaired. Normals, textures, materials and groups are skipped,
 references to other files are never opened. Hostile
 bytes may crash the decoder below, so a server calls this only in its sandboxed
 helper program.
 @retval kUnusableInput for empty, truncated, non-mesh bytes, indices out of
   range, NaN or infinite coordinates, no faces; the message names the format
   tried.
 @retval kTooLarge over a limit; also more vertices than three times the limit
   on triangles. Known before anything is allocated for the content: lines, or
   the counts in the header, are checked first, and these against the size.
 @param metres_per_unit  Unset: the file's own unit if it has one (DAE; glTF's
   is the metre), else metres.
 @pre metres_per_unit > 0. */
Result<TriangleMesh> ReadMesh(std::span<const uint8_t> bytes, MeshFormat format,
                              std::optional<double> metres_per_unit,
                              const MeshLimits& limits);

}  // namespace graspdb
