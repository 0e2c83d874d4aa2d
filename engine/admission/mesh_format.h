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

/** What ReadMesh() and ReadPointCloud() understand. */
enum class MeshFormat {
  kObj,
  kStl,
  kPly,  ///< A mesh, or without faces a cloud.
  kOff,
  kGlb,
  kGltf,
  kDae,
  kPcd,  ///< A cloud.
  kXyz,  ///< A cloud.
};

/** Every format, in the order of the enumeration. */
inline constexpr MeshFormat kMeshFormats[] = {
    MeshFormat::kObj, MeshFormat::kStl, MeshFormat::kPly,
    MeshFormat::kOff, MeshFormat::kGlb, MeshFormat::kGltf,
    MeshFormat::kDae, MeshFormat::kPcd, MeshFormat::kXyz};

/** Of nodes with transforms; may hold what is no surface. */
constexpr bool IsScene(MeshFormat format) {
  return format == MeshFormat::kGlb || format == MeshFormat::kGltf ||
         format == MeshFormat::kDae;
}

struct MeshLimits {
  int64_t max_bytes{64 << 20};
  int64_t max_triangles{400'000};
  int64_t max_points{1'000'000};
};

/** "OBJ", "STL", "glTF" … */
const char* GetName(MeshFormat format);

/** What to do when a format is not known or not meant. */
extern const char kFormatHint[];

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
