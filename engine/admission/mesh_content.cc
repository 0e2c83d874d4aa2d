#include "engine/admission/mesh_content.h"

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>

#include <fmt/core.h>

#include "engine/admission/ply_file.h"
#include "engine/admission/text_scanner.h"

namespace graspdb {
namespace {

// The vertex, from 0, that a face's corner ("7", "7/1/2", "-1") names when so
// many have been defined; nothing if there is no such vertex.
std::optional<int> FindObjVertex(std::string_view corner, int64_t defined) {
  int64_t index = 0;
  if (!ParseInteger(corner.substr(0, corner.find('/')), index)) {
    return std::nullopt;
  }
  index = index < 0 ? defined + index : index - 1;
  if (index < 0 || index >= std::numeric_limits<int>::max()) {
    return std::nullopt;
  }
  return static_cast<int>(index);
}

std::size_t CountWord(std::string_view text, std::string_view word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != text.npos;
       at = text.find(word, at + word.size())) {
    ++count;
  }
  return count;
}

Result<MeshContent> PrepareAsciiStl(std::string_view text,
                                    const MeshLimits& limits) {
  const std::size_t facets = CountWord(text, "endfacet");
  GRASPDB_TRY_VOID(CheckCounts(0, static_cast<int64_t>(facets), limits));
  if (facets == 0) return MakeFormatError(MeshFormat::kStl, "it has no faces");
  if (CountWord(text, "vertex") != 3 * facets ||
      CountWord(text, "endsolid") == 0) {
    return MakeFormatError(
        MeshFormat::kStl,
        "it is truncated or has facets that are no triangles");
  }
  return MeshContent{text};
}

}  // namespace

Error MakeFormatError(MeshFormat format, const std::string& what) {
  return Error{
      ErrorCode::kUnusableInput,
      fmt::format("the bytes cannot be read as {}: {}", GetName(format), what),
      kFormatHint, "mesh"};
}

Result<void> CheckSize(std::span<const uint8_t> bytes, MeshFormat format,
                       const MeshLimits& limits) {
  if (bytes.empty()) return MakeFormatError(format, "it is empty");
  if (static_cast<int64_t>(bytes.size()) <= limits.max_bytes) return {};
  return Error{ErrorCode::kTooLarge,
               fmt::format("the mesh has {} bytes; the limit is {}",
                           bytes.size(), limits.max_bytes),
               "Decimate the mesh first.", "mesh"};
}

Result<void> CheckCounts(int64_t vertices, int64_t triangles,
                         const MeshLimits& limits) {
  if (triangles > limits.max_triangles) {
    return Error{ErrorCode::kTooLarge,
                 fmt::format("the mesh has {} triangles; the limit is {}",
                             triangles, limits.max_triangles),
                 "Decimate the mesh first.", "mesh"};
  }
  if (vertices > 3 * limits.max_triangles) {
    return Error{ErrorCode::kTooLarge,
                 fmt::format("the mesh has {} vertices; the limit is {}",
                             vertices, 3 * limits.max_triangles),
                 "Decimate the mesh first.", "mesh"};
  }
  return {};
}

Result<MeshContent> PrepareObj(std::string_view text,
                               const MeshLimits& limits) {
  if (text.find('\0') != text.npos) {
    return MakeFormatError(MeshFormat::kObj, "it is not a text file");
  }
  MeshContent content{text};
  int64_t vertices = 0;
  int64_t triangles = 0;
  while (!text.empty()) {
    std::string line(Trim(TakeLine(text)));
    while (!line.empty() && line.back() == '\\' && !text.empty()) {
      line.back() = ' ';
      line += Trim(TakeLine(text));
    }
    std::string_view rest = line;
    const std::string_view keyword = TakeWord(rest);
    if (keyword == "v") {
      ++vertices;
      content.filtered += line + '\n';
    } else if (keyword == "f") {
      content.filtered += 'f';
      int64_t corners = 0;
      for (auto word = TakeWord(rest); !word.empty(); word = TakeWord(rest)) {
        const auto vertex = FindObjVertex(word, vertices);
        if (!vertex) {
          return MakeFormatError(MeshFormat::kObj, "a face names no vertex");
        }
        ++corners;
        content.corners.push_back(*vertex);
        content.filtered += fmt::format(" {}", *vertex + 1);
      }
      if (corners < 3) {
        return MakeFormatError(
            MeshFormat::kObj,
            fmt::format("it has a face with {} corners", corners));
      }
      triangles += corners - 2;
      content.filtered += '\n';
    }
    GRASPDB_TRY_VOID(CheckCounts(vertices, triangles, limits));
  }
  if (triangles == 0)
    return MakeFormatError(MeshFormat::kObj, "it has no faces");
  for (const int vertex : content.corners) {
    if (vertex >= vertices) {
      return MakeFormatError(MeshFormat::kObj,
                             "a face names a vertex that does not exist");
    }
  }
  return content;
}

Result<MeshContent> PrepareOff(std::string_view text,
                               const MeshLimits& limits) {
  const auto fail = [](const std::string& what) {
    return MakeFormatError(MeshFormat::kOff, what);
  };
  if (text.find('\0') != text.npos) return fail("it is not a text file");
  // The next line that says something, without its comment.
  const auto take = [&text] {
    while (!text.empty()) {
      std::string_view line = TakeLine(text);
      line = Trim(line.substr(0, line.find('#')));
      if (!line.empty()) return line;
    }
    return std::string_view();
  };
  std::string_view line = take();
  std::string_view keyword = TakeWord(line);
  if (!keyword.ends_with("OFF") ||
      keyword.find_first_of("4n") != keyword.npos) {
    return fail("it does not start with OFF");
  }
  if (Trim(line).empty()) line = take();
  int64_t vertices = 0;
  int64_t faces = 0;
  if (!ParseInteger(TakeWord(line), vertices) ||
      !ParseInteger(TakeWord(line), faces) || vertices < 0 || faces < 0) {
    return fail("it does not say how many vertices and faces it has");
  }
  GRASPDB_TRY_VOID(CheckCounts(vertices, faces, limits));
  MeshContent content{text};
  for (int64_t v = 0; v < vertices; ++v) {
    line = take();
    content.filtered += 'v';
    for (int i = 0; i < 3; ++i) {
      const std::string_view word = TakeWord(line);
      if (word.empty()) return fail("it is truncated");
      content.filtered += fmt::format(" {}", word);
    }
    content.filtered += '\n';
  }
  int64_t triangles = 0;
  for (int64_t f = 0; f < faces; ++f) {
    line = take();
    int64_t corners = 0;
    if (!ParseInteger(TakeWord(line), corners)) return fail("it is truncated");
    if (corners < 3) {
      return fail(fmt::format("it has a face with {} corners", corners));
    }
    triangles += corners - 2;
    GRASPDB_TRY_VOID(CheckCounts(vertices, triangles, limits));
    content.filtered += 'f';
    for (int64_t i = 0; i < corners; ++i) {
      int64_t vertex = 0;
      if (!ParseInteger(TakeWord(line), vertex)) return fail("it is truncated");
      if (vertex < 0 || vertex >= vertices) {
        return fail("a face names a vertex that does not exist");
      }
      content.corners.push_back(static_cast<int>(vertex));
      content.filtered += fmt::format(" {}", vertex + 1);
    }
    content.filtered += '\n';
  }
  if (triangles == 0) return fail("it has no faces");
  return content;
}

Result<MeshContent> PrepareStl(std::string_view bytes,
                               const MeshLimits& limits) {
  const std::span span(reinterpret_cast<const uint8_t*>(bytes.data()),
                       bytes.size());
  if (!IsBinaryStl(span) && Trim(bytes).starts_with("solid") &&
      bytes.find("facet") != bytes.npos) {
    return PrepareAsciiStl(bytes, limits);
  }
  if (bytes.size() < kBinaryStlHeader) {
    return MakeFormatError(
        MeshFormat::kStl,
        "it neither starts with \"solid\" nor has the 84 bytes of "
        "a binary header");
  }
  uint32_t count = 0;
  static_assert(std::endian::native == std::endian::little);
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  const std::size_t size = kBinaryStlHeader + kBinaryStlTriangle * count;
  if (count == 0 || size > bytes.size()) {
    return MakeFormatError(
        MeshFormat::kStl,
        fmt::format("its header announces {} triangles, which "
                    "take {} bytes; it has {}",
                    count, size, bytes.size()));
  }
  GRASPDB_TRY_VOID(CheckCounts(0, count, limits));
  return MeshContent{bytes.substr(0, size)};
}

Result<MeshContent> PreparePly(std::string_view bytes,
                               const MeshLimits& limits) {
  const auto fail = [](const std::string& what) {
    return MakeFormatError(MeshFormat::kPly, what);
  };
  std::string_view rest = bytes;
  const auto header = TakePlyHeader(rest);
  if (!header) return fail("its header is malformed");
  if (header->format != "ascii" && header->format != "binary_little_endian" &&
      header->format != "binary_big_endian") {
    return fail("its header names no known encoding");
  }
  PlyBody body(rest, header->format);
  int64_t vertices = 0;
  int64_t triangles = 0;
  for (const PlyElement& element : header->elements) {
    const bool is_face = element.name == "face";
    if (element.name == "vertex") {
      vertices += element.count;
      for (const char* name : {"x", "y", "z"}) {
        if (!FindProperty(element, name, false)) {
          return fail("its vertices lack a coordinate");
        }
      }
    } else if (is_face) {
      triangles += element.count;
      if (!FindProperty(element, "vertex_indices", true) &&
          !FindProperty(element, "vertex_index", true)) {
        return fail("its faces have no list of vertex indices");
      }
    }
    GRASPDB_TRY_VOID(CheckCounts(vertices, triangles, limits));
    const std::string truncated = fmt::format(
        "its header announces {} of element '{}', which are not "
        "there",
        element.count, element.name.substr(0, 32));
    if (element.count > 0 && !body.CouldHold(element)) return fail(truncated);
    for (int64_t row = 0; row < element.count; ++row) {
      for (const PlyProperty& property : element.properties) {
        int64_t count = 1;
        if (property.count_size > 0) {
          count = body.TakeCount(property.count_size);
          if (is_face && count > 3) triangles += count - 3;
        }
        if (count < 0 || !body.Skip(property.size, count)) {
          return fail(truncated);
        }
      }
    }
    GRASPDB_TRY_VOID(CheckCounts(vertices, triangles, limits));
  }
  if (vertices == 0) return fail("it has no vertices");
  if (triangles == 0) return fail("it has no faces, only points");
  MeshContent content{bytes};
  if (header->format != "ascii") {
    // The decoder takes a body's first byte for the rest of a line's end if it
    // looks like one: give it a line's end that has two bytes.
    const std::size_t head = bytes.size() - rest.size();
    content.filtered = Trim(bytes.substr(0, head - 1));
    content.filtered += "\r\n";
    content.filtered += rest;
  }
  return content;
}

}  // namespace graspdb
