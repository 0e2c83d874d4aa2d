#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/admission/mesh_format.h"
#include "engine/base/result.h"

/** @file
 What can be checked of a mesh file before a library decodes it: that it holds
 what it announces, and no more than the limits allow. */

namespace graspdb {

/** What the decoder gets to see: the file's bytes, or what was made of them. */
struct MeshContent {
  std::string_view original;
  std::string filtered{};
  /** Of an OBJ: the file's vertex that each corner of each face names. */
  std::vector<int> corners{};

  std::string_view bytes() const {
    return filtered.empty() ? original : std::string_view(filtered);
  }
};

/** "the bytes cannot be read as PLY: …". */
Error MakeFormatError(MeshFormat format, const std::string& what);

/** @retval kUnusableInput when empty. @retval kTooLarge over max_bytes. */
Result<void> CheckSize(std::span<const uint8_t> bytes, MeshFormat format,
                       const MeshLimits& limits);

/** @retval kTooLarge over a limit; also more than three vertices a triangle. */
Result<void> CheckCounts(int64_t vertices, int64_t triangles,
                         const MeshLimits& limits);

/** Only the vertices and the faces' vertex indices pass, so that the decoder
 meets neither references nor groups, which would reorder the faces. It makes a
 vertex of every corner; the indices are kept to undo that. */
Result<MeshContent> PrepareObj(std::string_view text, const MeshLimits& limits);

/** The same as an OBJ, which it becomes: "OFF", perhaps with a prefix, counts,
 vertices, faces; what follows on a line is left out. */
Result<MeshContent> PrepareOff(std::string_view text, const MeshLimits& limits);

Result<MeshContent> PrepareStl(std::string_view bytes,
                               const MeshLimits& limits);

/** Every value that the header announces must be there. */
Result<MeshContent> PreparePly(std::string_view bytes,
                               const MeshLimits& limits);

}  // namespace graspdb
