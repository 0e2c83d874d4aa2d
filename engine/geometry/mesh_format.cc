#include "engine/geometry/mesh_format.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <string_view>
#include <utility>

namespace graspdb {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

// Cuts the next line off the text. @returns it without blanks around it.
std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  return line.substr(0, line.find_last_not_of(kBlanks) + 1);
}

}  // namespace

bool IsBinaryStl(std::span<const uint8_t> bytes) {
  if (bytes.size() < kBinaryStlHeader) return false;
  uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  return bytes.size() == kBinaryStlHeader + kBinaryStlTriangle * count;
}

const char* GetName(MeshFormat format) {
  switch (format) {
    case MeshFormat::kObj:
      return "OBJ";
    case MeshFormat::kStl:
      return "STL";
    case MeshFormat::kPly:
      break;
  }
  return "PLY";
}

Result<MeshFormat> ParseMeshFormat(const std::string& name) {
  static constexpr std::pair<std::string_view, MeshFormat> kSpellings[] = {
      {"obj", MeshFormat::kObj},
      {".obj", MeshFormat::kObj},
      {"model/obj", MeshFormat::kObj},
      {"stl", MeshFormat::kStl},
      {".stl", MeshFormat::kStl},
      {"model/stl", MeshFormat::kStl},
      {"model/x.stl-ascii", MeshFormat::kStl},
      {"model/x.stl-binary", MeshFormat::kStl},
      {"application/sla", MeshFormat::kStl},
      {"application/vnd.ms-pki.stl", MeshFormat::kStl},
      {"ply", MeshFormat::kPly},
      {".ply", MeshFormat::kPly},
      {"model/ply", MeshFormat::kPly},
      {"model/x-ply", MeshFormat::kPly},
      {"application/ply", MeshFormat::kPly}};
  std::string lower = name;
  for (char& c : lower) {
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  for (const auto& [spelling, format] : kSpellings) {
    if (lower == spelling) return format;
  }
  return Error{ErrorCode::kInvalidArgument, "the mesh format is not known",
               "Known are obj, stl and ply.", "format"};
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
  while (!text.empty()) {
    const std::string_view line = TakeLine(text);
    if (line.empty() || line.front() == '#') continue;
    const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
    if (word == "ply") return MeshFormat::kPly;
    if (word.starts_with("solid")) return MeshFormat::kStl;
    for (const char* keyword :
         {"v", "vt", "vn", "f", "o", "g", "s", "mtllib", "usemtl"}) {
      if (word == keyword) return MeshFormat::kObj;
    }
    break;
  }
  return Error{ErrorCode::kUnusableInput,
               bytes.empty() ? "the mesh is empty"
                             : "the bytes look like no known mesh format",
               "Send a mesh as OBJ, STL or PLY, and name its format.", "mesh"};
}

}  // namespace graspdb
