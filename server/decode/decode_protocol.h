#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/geometry/mesh_format.h"
#include "engine/geometry/triangle_mesh.h"

/** @file
 What the server and its decoding helper say to each other, once: a request, the
 mesh file's bytes right after it, one answer. Little-endian; sizes before
 contents. Neither side trusts the other's bytes. */

namespace graspdb {

/** How a mesh file is to be read. */
struct DecodeRequest {
  std::optional<MeshFormat> format;  ///< Unset: by name, else by content.
  std::string file_name;             ///< May be empty.
  double metres_per_unit{1.0};       ///< Positive.
  MeshLimits limits;
  int work_triangles{
      5000};  ///< The working mesh is decimated to so many, >= 4.
};

/** What the helper made of it. */
struct DecodeAnswer {
  TriangleMesh mesh_O;  ///< Full resolution.
  TriangleMesh work_O;  ///< Working resolution.
  std::vector<std::string> repairs;
  std::string format;       ///< "OBJ", "STL" or "PLY".
  std::string confinement;  ///< How the helper was confined.
};

/** The bytes that go before the mesh file's bytes. */
std::vector<uint8_t> EncodeRequest(const DecodeRequest& request);

/** Takes a request apart; `mesh` becomes the bytes behind it.
 @returns nothing when the bytes are no request. */
std::optional<DecodeRequest> ParseRequest(std::span<const uint8_t> bytes,
                                          std::span<const uint8_t>* mesh);

std::vector<uint8_t> EncodeAnswer(const Result<DecodeAnswer>& answer);

/** Takes an answer apart and checks it: sizes, indices, finite coordinates,
 both meshes closed, error codes that a decoder may give; text comes out as
 printable ASCII.
 @returns nothing when the bytes are no such answer. */
std::optional<Result<DecodeAnswer>> ParseAnswer(std::span<const uint8_t> bytes);

}  // namespace graspdb
