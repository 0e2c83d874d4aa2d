#pragma once

#include <cstdint>

#include "engine/admission/mesh_format.h"
#include "server/codec/json.h"

namespace graspdb {

inline constexpr uint64_t kMostFaces = MeshLimits{}.max_triangles;

/** Of JSON in which each face may have its label: as ranges, of three values
 each, at worst. */
inline constexpr JsonLimits kLabelLimits{64 << 20, 64, 3 * kMostFaces + 1000};

}  // namespace graspdb
