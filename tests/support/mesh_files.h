#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "engine/geometry/triangle_mesh.h"

/** @file
 Mesh files written in the plainest way, for tests of what reads them. */

namespace graspdb {

using FileBytes = std::vector<uint8_t>;

inline FileBytes ToBytes(std::string_view text) {
  return {text.begin(), text.end()};
}

/** Appends a value's bytes, the lowest first or last. */
template <typename T>
void AppendValue(FileBytes& bytes, T value, bool big_endian = false) {
  uint8_t raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (big_endian) std::reverse(raw, raw + sizeof(T));
  for (const uint8_t byte : raw) bytes.push_back(byte);
}

inline FileBytes MakeObj(const TriangleMesh& mesh) {
  std::string text;
  for (const Eigen::Vector3d& p : mesh.vertices()) {
    text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  }
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  return ToBytes(text);
}

inline FileBytes MakeAsciiStl(const TriangleMesh& mesh) {
  std::string text = "solid mesh\n";
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d& p = mesh.corner(f, k);
      text += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
    }
    text += "endloop\nendfacet\n";
  }
  return ToBytes(text + "endsolid mesh\n");
}

inline FileBytes MakeBinaryStl(const TriangleMesh& mesh) {
  FileBytes bytes(80, ' ');
  AppendValue(bytes, static_cast<uint32_t>(mesh.num_triangles()));
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    for (int k = 0; k < 3; ++k) AppendValue(bytes, 0.0f);
    for (int k = 0; k < 3; ++k) {
      for (const double x : mesh.corner(f, k)) {
        AppendValue(bytes, static_cast<float>(x));
      }
    }
    AppendValue(bytes, uint16_t{0});
  }
  return bytes;
}

inline FileBytes MakePlyHeader(const TriangleMesh& mesh,
                               std::string_view format) {
  return ToBytes(
      fmt::format("ply\nformat {} 1.0\ncomment made by a test\n"
                  "element vertex {}\nproperty float x\nproperty float y\n"
                  "property float z\nelement face {}\n"
                  "property list uchar int vertex_indices\nend_header\n",
                  format, mesh.num_vertices(), mesh.num_triangles()));
}

inline FileBytes MakeAsciiPly(const TriangleMesh& mesh) {
  FileBytes bytes = MakePlyHeader(mesh, "ascii");
  std::string text;
  for (const Eigen::Vector3d& p : mesh.vertices()) {
    text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  }
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  }
  bytes.insert(bytes.end(), text.begin(), text.end());
  return bytes;
}

inline FileBytes MakeBinaryPly(const TriangleMesh& mesh, bool big_endian) {
  FileBytes bytes = MakePlyHeader(
      mesh, big_endian ? "binary_big_endian" : "binary_little_endian");
  for (const Eigen::Vector3d& p : mesh.vertices()) {
    for (const double x : p) {
      AppendValue(bytes, static_cast<float>(x), big_endian);
    }
  }
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    AppendValue(bytes, uint8_t{3});
    for (const int v : t) AppendValue(bytes, v, big_endian);
  }
  return bytes;
}

/** Every encoding that the reader knows, with the file name to give it. */
inline std::vector<std::pair<std::string, FileBytes>> MakeEveryFile(
    const TriangleMesh& mesh) {
  return {{"a.obj", MakeObj(mesh)},
          {"ascii.stl", MakeAsciiStl(mesh)},
          {"binary.stl", MakeBinaryStl(mesh)},
          {"ascii.ply", MakeAsciiPly(mesh)},
          {"little.ply", MakeBinaryPly(mesh, false)},
          {"big.ply", MakeBinaryPly(mesh, true)}};
}

}  // namespace graspdb
