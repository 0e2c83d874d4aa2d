#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/result.h"
#include "engine/geometry/triangle_mesh.h"
#include "engine/hand/hand_model.h"
#include "engine/planning/grasp.h"
#include "engine/segmentation/part.h"

/** @file
 Values as bytes, for the database's blobs: a version byte, a byte for the kind
 of value, little-endian int32 counts and indices, little-endian float64
 numbers, and CRC-32 of all before it (schema/README.md has the layouts).
 Decoders accept any bytes: what is not exactly a sound encoding of a value of
 that kind is kStorage. Encoding is exact, so decode(encode(x)) == x. */

namespace graspdb {

std::string EncodeMesh(const TriangleMesh& mesh);
Result<TriangleMesh> DecodeMesh(std::string_view bytes);

/** Face labels, or the faces of a part. */
std::string EncodeIndices(const std::vector<int>& indices);
Result<std::vector<int>> DecodeIndices(std::string_view bytes);

std::string EncodePoints(const std::vector<Eigen::Vector3d>& points);
Result<std::vector<Eigen::Vector3d>> DecodePoints(std::string_view bytes);

std::string EncodePose(const RigidTransform& X_AB);
Result<RigidTransform> DecodePose(std::string_view bytes);

/** A part whole, but for its confidence. */
std::string EncodePart(const Part& part);
Result<Part> DecodePart(std::string_view bytes);

std::string EncodeConfigurations(
    const std::vector<HandConfiguration>& configurations);
Result<std::vector<HandConfiguration>> DecodeConfigurations(
    std::string_view bytes);

/** A grasp without its quality, which has columns of its own, and the images of
 its source's contacts. */
struct GraspBlob {
  Grasp grasp;
  std::vector<std::optional<Eigen::Vector3d>> targets_O;
};
std::string EncodeGrasp(const GraspBlob& blob);
Result<GraspBlob> DecodeGrasp(std::string_view bytes);

}  // namespace graspdb
