#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "engine/base/result.h"

/** @file
 What a mesh file is, apart from its decoder: servers need the names without
 the decoding libraries. */

namespace graspdb {

/** The mesh formats that ReadMesh() understands. */
enum class MeshFormat { kObj, kStl, kPly };

struct MeshLimits {
  int64_t max_bytes{64 << 20};
  int64_t max_triangles{400'000};
};

/** "OBJ", "STL" or "PLY". */
const char* GetName(MeshFormat format);

/** Names a format from its usual spellings ("obj", ".STL", "model/stl" …).
 @retval kInvalidArgument naming the formats known. */
Result<MeshFormat> ParseMeshFormat(const std::string& name);

inline constexpr std::size_t kBinaryStlHeader = 84;
inline constexpr std::size_t kBinaryStlTriangle = 50;

/** True when the size is just what the header of a binary STL announces. */
bool IsBinaryStl(std::span<const uint8_t> bytes);

/** Guesses from the file name's extension if that is a known one, else from the
 first bytes.
 @retval kUnusableInput when neither tells. */
Result<MeshFormat> GuessMeshFormat(std::span<const uint8_t> bytes,
                                   const std::string& file_name);

}  // namespace graspdb
