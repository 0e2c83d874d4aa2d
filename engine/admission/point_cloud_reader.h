#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/admission/mesh_format.h"
#include "engine/base/result.h"

namespace graspdb {

/** Whether a file is to be read by ReadPointCloud(): a PCD, an XYZ, a PLY whose
 header announces vertices and no face. */
bool HoldsPointsOnly(std::span<const uint8_t> bytes, MeshFormat format);

/** The points p_O of a cloud in the file's order, those without a position (NaN
 or infinite, as scanners write where they saw nothing) left out: PLY and PCD
 (text, binary, compressed), XYZ (three numbers a line, apart by blanks, commas
 or semicolons; what follows them, and lines that start with # or //, are left
 out, as is a first line with one number). Normals, colours and a PCD's
 viewpoint are skipped. Hostile bytes: only in the sandbox.
 @param metres_per_unit  Positive.
 @retval kUnusableInput for empty, truncated or malformed bytes.
 @retval kTooLarge over a limit, known before anything is allocated for it. */
Result<std::vector<Eigen::Vector3d>> ReadPointCloud(
    std::span<const uint8_t> bytes, MeshFormat format, double metres_per_unit,
    const MeshLimits& limits);

}  // namespace graspdb
