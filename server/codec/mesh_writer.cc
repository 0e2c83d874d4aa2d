#include "server/codec/mesh_writer.h"

#include <bit>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

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

}  // namespace

std::string WriteMesh(const TriangleMesh& mesh, MeshFormat format) {
  switch (format) {
    case MeshFormat::kObj:
      return WriteObj(mesh);
    case MeshFormat::kStl:
      return WriteStl(mesh);
    case MeshFormat::kPly:
      return WritePly(mesh);
  }
  return {};
}

}  // namespace graspdb
