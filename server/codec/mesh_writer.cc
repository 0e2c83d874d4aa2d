#include "server/codec/mesh_writer.h"

#include <bit>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "engine/base/contract.h"
#include "server/codec/json.h"

namespace graspdb {
namespace {

static_assert(std::endian::native == std::endian::little);

template <class T>
void Append(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

std::string WriteObj(const TriangleMesh& mesh) {
  std::string text = "# metres\n";
  const auto out = std::back_inserter(text);
  for (const Eigen::Vector3d& v : mesh.vertices()) {
    fmt::format_to(out, "v {} {} {}\n", v.x(), v.y(), v.z());
  }
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    fmt::format_to(out, "f {} {} {}\n", t.x() + 1, t.y() + 1, t.z() + 1);
  }
  return text;
}

std::string WriteStl(const TriangleMesh& mesh) {
  std::string bytes = "binary STL, metres";
  bytes.resize(80, ' ');
  Append(bytes, static_cast<uint32_t>(mesh.num_triangles()));
  const auto append_point = [&](const Eigen::Vector3d& point) {
    for (const double x : point) Append(bytes, static_cast<float>(x));
  };
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    append_point(mesh.normal(f));
    for (int k = 0; k < 3; ++k) append_point(mesh.corner(f, k));
    Append(bytes, uint16_t{0});
  }
  return bytes;
}

std::string WritePly(const TriangleMesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment metres\n"
      "element vertex {}\nproperty double x\nproperty double y\n"
      "property double z\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      mesh.num_vertices(), mesh.num_triangles());
  for (const Eigen::Vector3d& vertex : mesh.vertices()) {
    for (const double x : vertex) Append(bytes, x);
  }
  for (const Eigen::Vector3i& triangle : mesh.triangles()) {
    Append(bytes, uint8_t{3});
    for (const int index : triangle) {
      Append(bytes, static_cast<int32_t>(index));
    }
  }
  return bytes;
}

// One node, one primitive: a JSON chunk padded by spaces, then a binary chunk.
std::string WriteGlb(const TriangleMesh& mesh) {
  std::string binary;
  for (const Eigen::Vector3d& vertex : mesh.vertices()) {
    for (const double x : vertex) Append(binary, static_cast<float>(x));
  }
  const size_t positions = binary.size();
  for (const Eigen::Vector3i& triangle : mesh.triangles()) {
    for (const int index : triangle) {
      Append(binary, static_cast<uint32_t>(index));
    }
  }
  const Eigen::Vector3f low = mesh.box_min().cast<float>();
  const Eigen::Vector3f high = mesh.box_max().cast<float>();
  Json json;
  json["asset"] = {{"version", "2.0"}, {"generator", "graspdb"}};
  json["scene"] = 0;
  json["scenes"] = {{{"nodes", {0}}}};
  json["nodes"] = {{{"mesh", 0}}};
  json["meshes"] = {
      {{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}};
  json["accessors"] = {{{"bufferView", 0},
                        {"componentType", 5126},  // FLOAT
                        {"count", mesh.num_vertices()},
                        {"type", "VEC3"},
                        {"min", {low.x(), low.y(), low.z()}},
                        {"max", {high.x(), high.y(), high.z()}}},
                       {{"bufferView", 1},
                        {"componentType", 5125},  // UNSIGNED_INT
                        {"count", 3 * mesh.num_triangles()},
                        {"type", "SCALAR"}}};
  json["bufferViews"] = {
      {{"buffer", 0}, {"byteOffset", 0}, {"byteLength", positions}},
      {{"buffer", 0},
       {"byteOffset", positions},
       {"byteLength", binary.size() - positions}}};
  json["buffers"] = {{{"byteLength", binary.size()}}};
  std::string text = DumpJson(json);
  text.resize((text.size() + 3) / 4 * 4, ' ');

  constexpr uint32_t kHeader = 12, kChunkHeader = 8;
  std::string bytes = "glTF";
  Append(bytes, uint32_t{2});
  Append(bytes, static_cast<uint32_t>(kHeader + 2 * kChunkHeader + text.size() +
                                      binary.size()));
  Append(bytes, static_cast<uint32_t>(text.size()));
  bytes += "JSON" + text;
  Append(bytes, static_cast<uint32_t>(binary.size()));
  bytes += std::string("BIN\0", 4) + binary;
  return bytes;
}

}  // namespace

std::string WriteMesh(const TriangleMesh& mesh, MeshFormat format) {
  switch (format) {
    case MeshFormat::kObj:
      return WriteObj(mesh);
    case MeshFormat::kStl:
      return WriteStl(mesh);
    case MeshFormat::kPly:
      return WritePly(mesh);
    case MeshFormat::kGlb:
      return WriteGlb(mesh);
    default:
      break;
  }
  GRASPDB_EXPECTS(false);
}

}  // namespace graspdb
