#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/base/result.h"
#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** The mesh formats that ReadMesh() understands. */
enum class MeshFormat { kObj, kStl, kPly };

struct MeshLimits {
  int64_t max_bytes{64 << 20};
  int64_t max_triangles{400'000};
};

/** Names a format from its usual spellings ("obj", ".STL", "model/stl" …).
 @retval kInvalidArgument naming the formats known. */
Result<MeshFormat> ParseMeshFormat(const std::string& name);

/** Guesses from the file name if there is one, else from the first bytes.
 @retval kUnusableInput when neither tells. */
Result<MeshFormat> GuessMeshFormat(std::span<const uint8_t> bytes,
                                   const std::string& file_name);

/** Decodes a triangle soup, exactly as in the file: one vertex per index, no
 weld, no repair; multiplied by metres_per_unit. Polygons are triangulated.
 References to other files are never opened. Hostile bytes may crash the decoder
 below, so a server calls this only in its sandboxed helper program.
 @retval kUnusableInput for empty, truncated, non-mesh bytes, indices out of
   range, NaN or infinite coordinates; the message names the format tried.
 @retval kTooLarge over a limit, known before the bytes are decoded. */
Result<TriangleMesh> ReadMesh(std::span<const uint8_t> bytes, MeshFormat format,
                              double metres_per_unit, const MeshLimits& limits);

}  // namespace graspdb
