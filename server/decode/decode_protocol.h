#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/admission/cloud_report.h"
#include "engine/admission/mesh_format.h"
#include "engine/base/result.h"
#include "engine/geometry/triangle_mesh.h"
#include "engine/hand/hand_tree.h"

/** @file
 What the server and its decoding helper say to each other, once: a request, the
 bytes of a mesh file or a URDF right after it, one answer. Little-endian; sizes
 before contents. Neither side trusts the other's bytes. */

namespace graspdb {

/** How a mesh file is to be read. */
struct DecodeRequest {
  std::optional<MeshFormat> format;  ///< Unset: by name, else by content.
  std::string file_name;             ///< May be empty.
  std::optional<double> metres_per_unit{};  ///< Positive; unset: ReadMesh().
  MeshLimits limits;
  int work_triangles{
      5000};  ///< The working mesh is decimated to so many, >= 4.
};

/** What a point cloud told of its object. */
struct DecodedCloud {
  CloudReport report;
  double seen_share{0.0};  ///< Of the surface that points support, 0..1.
  std::vector<Eigen::Vector3d> points_O;  ///< Those that the mesh goes by, m.
};

/** What decoding took of one core, s: for reports. */
struct DecodeSeconds {
  double read{0.0};      ///< The file; of a cloud, its surface, too.
  double repair{0.0};    ///< Until it was a closed solid.
  double decimate{0.0};  ///< To the working mesh.
};

/** What the helper made of it. */
struct DecodeAnswer {
  TriangleMesh mesh_O;  ///< Full resolution.
  TriangleMesh work_O;  ///< Working resolution.
  std::vector<std::string> repairs;
  std::string format;                   ///< As GetName() has it.
  std::string confinement;              ///< How the helper was confined.
  std::optional<DecodedCloud> cloud{};  ///< Unset for a mesh.
  DecodeSeconds seconds{};
};

/** The bytes that go before the mesh file's bytes. */
std::vector<uint8_t> EncodeRequest(const DecodeRequest& request);

/** Takes a request apart; `mesh` becomes the bytes behind it.
 @returns nothing when the bytes are no request. */
std::optional<DecodeRequest> ParseRequest(std::span<const uint8_t> bytes,
                                          std::span<const uint8_t>* mesh);

/** The bytes that go before a URDF's. */
std::vector<uint8_t> EncodeUrdfRequest();

/** @returns the URDF behind the request, or nothing when the bytes are no such
 request. */
std::optional<std::span<const uint8_t>> ParseUrdfRequest(
    std::span<const uint8_t> bytes);

std::vector<uint8_t> EncodeAnswer(const Result<DecodeAnswer>& answer);
std::vector<uint8_t> EncodeHandAnswer(const Result<HandTree>& answer);

/** Takes an answer apart and checks it: sizes, indices, finite coordinates,
 both meshes closed, error codes that a decoder may give; text comes out as
 printable ASCII.
 @returns nothing when the bytes are no such answer. */
std::optional<Result<DecodeAnswer>> ParseAnswer(std::span<const uint8_t> bytes);

/** The same for the answer to a URDF, which must pass CheckHandTree(). */
std::optional<Result<HandTree>> ParseHandAnswer(std::span<const uint8_t> bytes);

}  // namespace graspdb
