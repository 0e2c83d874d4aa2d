#include "engine/admission/mesh_format.h"

#include <cstring>
#include <string_view>
#include <utility>

#include "engine/admission/text_scanner.h"

namespace graspdb {
namespace {

// Whether a line holds three or more numbers, or one, which may be how many
// follow, and nothing else.
bool LooksLikeXyz(std::string line) {
  for (char& c : line) {
    if (c == ',' || c == ';') c = ' ';
  }
  std::string_view rest = line;
  int numbers = 0;
  for (auto word = TakeWord(rest); !word.empty(); word = TakeWord(rest)) {
    if (!ParseNumber(word)) return false;
    ++numbers;
  }
  return numbers == 1 || numbers >= 3;
}

}  // namespace

bool IsBinaryStl(std::span<const uint8_t> bytes) {
  if (bytes.size() < kBinaryStlHeader) return false;
  uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  return bytes.size() == kBinaryStlHeader + kBinaryStlTriangle * count;
}

const char kFormatHint[] =
    "Send a mesh as OBJ, STL, PLY, OFF, GLB, glTF or DAE, or a cloud as PLY, "
    "PCD or XYZ, and name its format.";

const char* GetName(MeshFormat format) {
  switch (format) {
    case MeshFormat::kObj:
      return "OBJ";
    case MeshFormat::kStl:
      return "STL";
    case MeshFormat::kPly:
      return "PLY";
    case MeshFormat::kOff:
      return "OFF";
    case MeshFormat::kGlb:
      return "GLB";
    case MeshFormat::kGltf:
      return "glTF";
    case MeshFormat::kDae:
      return "DAE";
    case MeshFormat::kPcd:
      return "PCD";
    case MeshFormat::kXyz:
      break;
  }
  return "XYZ";
}

Result<MeshFormat> ParseMeshFormat(const std::string& name) {
  static constexpr std::pair<std::string_view, MeshFormat> kMediaTypes[] = {
      {"model/obj", MeshFormat::kObj},
      {"model/stl", MeshFormat::kStl},
      {"model/x.stl-ascii", MeshFormat::kStl},
      {"model/x.stl-binary", MeshFormat::kStl},
      {"application/sla", MeshFormat::kStl},
      {"application/vnd.ms-pki.stl", MeshFormat::kStl},
      {"model/ply", MeshFormat::kPly},
      {"model/x-ply", MeshFormat::kPly},
      {"application/ply", MeshFormat::kPly},
      {"model/gltf-binary", MeshFormat::kGlb},
      {"model/gltf+json", MeshFormat::kGltf},
      {"model/vnd.collada+xml", MeshFormat::kDae},
      {"chemical/x-xyz", MeshFormat::kXyz}};
  const std::string lower = ToLower(name);
  for (const auto& [type, format] : kMediaTypes) {
    if (lower == type) return format;
  }
  for (const MeshFormat format : kMeshFormats) {
    const std::string extension = ToLower(GetName(format));
    if (lower == extension || lower == "." + extension) return format;
  }
  return Error{ErrorCode::kInvalidArgument, "the mesh format is not known",
               "Known are obj, stl, ply, off, glb, gltf, dae, pcd and xyz.",
               "format"};
}

Result<MeshFormat> GuessMeshFormat(std::span<const uint8_t> bytes,
                                   const std::string& file_name) {
  const std::size_t dot = file_name.rfind('.');
  if (dot != file_name.npos) {
    if (auto format = ParseMeshFormat(file_name.substr(dot))) return format;
  }
  if (IsBinaryStl(bytes)) return MeshFormat::kStl;
  std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                        bytes.size());
  if (text.starts_with("glTF")) return MeshFormat::kGlb;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  while (!text.empty()) {
    const std::string_view line = Trim(TakeLine(text));
    if (line.starts_with("# .PCD")) return MeshFormat::kPcd;
    if (line.empty() || line.front() == '#') continue;
    std::string_view rest = line;
    const std::string_view word = TakeWord(rest);
    if (word == "ply") return MeshFormat::kPly;
    if (word.starts_with("solid")) return MeshFormat::kStl;
    if (word == "VERSION" || word == "FIELDS") return MeshFormat::kPcd;
    if (word.ends_with("OFF")) return MeshFormat::kOff;
    if (line.starts_with("{")) return MeshFormat::kGltf;
    if (line.starts_with("<?xml") || line.starts_with("<COLLADA")) {
      return MeshFormat::kDae;
    }
    for (const char* keyword :
         {"v", "vt", "vn", "f", "o", "g", "s", "mtllib", "usemtl"}) {
      if (word == keyword) return MeshFormat::kObj;
    }
    if (LooksLikeXyz(std::string(line))) return MeshFormat::kXyz;
    break;
  }
  return Error{ErrorCode::kUnusableInput,
               bytes.empty() ? "the mesh is empty"
                             : "the bytes look like no known mesh format",
               kFormatHint, "mesh"};
}

}  // namespace graspdb
