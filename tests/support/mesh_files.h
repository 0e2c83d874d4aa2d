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

inline FileBytes MakeOff(const TriangleMesh& mesh) {
  std::string text = fmt::format("OFF # by a test\n{} {} 0\n\n",
                                 mesh.num_vertices(), mesh.num_triangles());
  for (const Eigen::Vector3d& p : mesh.vertices()) {
    text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  }
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    text += fmt::format("3 {} {} {} 255 0 0\n", t[0], t[1], t[2]);
  }
  return ToBytes(text);
}

/** Positions as floats, then indices as 32-bit numbers. */
inline FileBytes MakeGltfBuffer(const TriangleMesh& mesh) {
  FileBytes bytes;
  for (const Eigen::Vector3d& p : mesh.vertices()) {
    for (const double x : p) AppendValue(bytes, static_cast<float>(x));
  }
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    for (const int v : t) AppendValue(bytes, static_cast<uint32_t>(v));
  }
  return bytes;
}

/** @param uri  Of the buffer, as `"uri": "…", `; empty in a GLB.
 @param nodes  The node list. */
inline std::string MakeGltfJson(const TriangleMesh& mesh,
                                const std::string& uri,
                                const std::string& nodes) {
  const int positions = 12 * mesh.num_vertices();
  const int indices = 12 * mesh.num_triangles();
  return fmt::format(
      R"({{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
"nodes": {}, "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}},
"indices": 1}}]}}], "accessors": [{{"bufferView": 0, "componentType": 5126,
"count": {}, "type": "VEC3", "min": [-9, -9, -9], "max": [9, 9, 9]}},
{{"bufferView": 1, "componentType": 5125, "count": {}, "type": "SCALAR"}}],
"bufferViews": [{{"buffer": 0, "byteOffset": 0, "byteLength": {}}},
{{"buffer": 0, "byteOffset": {}, "byteLength": {}}}],
"buffers": [{{{}"byteLength": {}}}]}})",
      nodes, mesh.num_vertices(), 3 * mesh.num_triangles(), positions,
      positions, indices, uri, positions + indices);
}

inline constexpr char kOneNode[] = R"([{"mesh": 0}])";

inline FileBytes MakeGlb(const TriangleMesh& mesh,
                         const std::string& nodes = kOneNode) {
  std::string json = MakeGltfJson(mesh, "", nodes);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const FileBytes buffer = MakeGltfBuffer(mesh);
  FileBytes bytes = ToBytes("glTF");
  AppendValue(bytes, uint32_t{2});
  AppendValue(bytes, static_cast<uint32_t>(28 + json.size() + buffer.size()));
  AppendValue(bytes, static_cast<uint32_t>(json.size()));
  const FileBytes text = ToBytes("JSON" + json);
  bytes.insert(bytes.end(), text.begin(), text.end());
  AppendValue(bytes, static_cast<uint32_t>(buffer.size()));
  const FileBytes kind = ToBytes(std::string_view("BIN\0", 4));
  bytes.insert(bytes.end(), kind.begin(), kind.end());
  bytes.insert(bytes.end(), buffer.begin(), buffer.end());
  return bytes;
}

inline std::string ToBase64(const FileBytes& bytes) {
  constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63];
    }
  }
  return text;
}

/** With its buffer inside. */
inline FileBytes MakeGltf(const TriangleMesh& mesh) {
  return ToBytes(
      MakeGltfJson(mesh,
                   R"("uri": "data:application/octet-stream;base64,)" +
                       ToBase64(MakeGltfBuffer(mesh)) + R"(", )",
                   kOneNode));
}

/** @param unit  Of the asset, metres.
 @param up  "X_UP", "Y_UP" or "Z_UP". */
inline FileBytes MakeDae(const TriangleMesh& mesh, double unit = 1.0,
                         const std::string& up = "Z_UP") {
  std::string positions, indices;
  for (const Eigen::Vector3d& p : mesh.vertices()) {
    positions += fmt::format("{} {} {} ", p.x(), p.y(), p.z());
  }
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    indices += fmt::format("{} {} {} ", t[0], t[1], t[2]);
  }
  return ToBytes(fmt::format(
      R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter="{}"/><up_axis>{}</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="{}">{}</float_array>
<technique_common><accessor source="#a" count="{}" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="{}"><input semantic="VERTEX" source="#v" offset="0"/>
<p>{}</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n">
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
)",
      unit, up, 3 * mesh.num_vertices(), positions, mesh.num_vertices(),
      mesh.num_triangles(), indices));
}

/** Every encoding that the reader knows, with the file name to give it. */
inline std::vector<std::pair<std::string, FileBytes>> MakeEveryFile(
    const TriangleMesh& mesh) {
  return {{"a.obj", MakeObj(mesh)},
          {"ascii.stl", MakeAsciiStl(mesh)},
          {"binary.stl", MakeBinaryStl(mesh)},
          {"ascii.ply", MakeAsciiPly(mesh)},
          {"little.ply", MakeBinaryPly(mesh, false)},
          {"big.ply", MakeBinaryPly(mesh, true)},
          {"a.off", MakeOff(mesh)},
          {"a.glb", MakeGlb(mesh)},
          {"a.gltf", MakeGltf(mesh)},
          {"a.dae", MakeDae(mesh)}};
}

}  // namespace graspdb
