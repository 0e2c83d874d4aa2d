#include "engine/geometry/mesh_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <numeric>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <assimp/BaseImporter.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>
#include <fmt/core.h>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

constexpr char kFormatHint[] =
    "Send a mesh as OBJ, STL or PLY, and name its format.";

std::string ToLower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return lower;
}

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view Trim(std::string_view text) {
  while (!text.empty() && IsBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsBlank(text.back())) text.remove_suffix(1);
  return text;
}

// Cuts the next line, without its end, off the text.
std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

// Cuts the next word off the text; empty at the end.
std::string_view TakeWord(std::string_view& text) {
  const auto is_space = [](char c) { return IsBlank(c) || c == '\n'; };
  const auto begin = std::find_if_not(text.begin(), text.end(), is_space);
  const auto end = std::find_if(begin, text.end(), is_space);
  const std::string_view word(begin, end);
  text.remove_prefix(static_cast<std::size_t>(end - text.begin()));
  return word;
}

std::string_view ToText(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Error MakeError(MeshFormat format, const std::string& what) {
  return Error{
      ErrorCode::kUnusableInput,
      fmt::format("the bytes cannot be read as {}: {}", GetName(format), what),
      kFormatHint, "mesh"};
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

// What the decoder gets to see: the file's bytes, or what was made of them.
struct Content {
  std::string_view original;
  std::string filtered{};
  // Of an OBJ: the file's vertex that each corner of each face names.
  std::vector<int> corners{};

  std::string_view bytes() const {
    return filtered.empty() ? original : std::string_view(filtered);
  }
};

// ---- OBJ: only the vertices and the faces' vertex indices pass, so that the
// decoder meets neither references nor groups, which would reorder the faces.
// It makes a vertex of every corner; the indices are kept to undo that.

// The vertex, from 0, that a face's corner ("7", "7/1/2", "-1") names when so
// many have been defined; nothing if there is no such vertex.
std::optional<int> FindObjVertex(std::string_view corner, int64_t defined) {
  const std::string_view number = corner.substr(0, corner.find('/'));
  int64_t index = 0;
  const auto [end, error] =
      std::from_chars(number.data(), number.data() + number.size(), index);
  if (error != std::errc() || end != number.data() + number.size()) {
    return std::nullopt;
  }
  index = index < 0 ? defined + index : index - 1;
  if (index < 0 || index >= std::numeric_limits<int>::max()) {
    return std::nullopt;
  }
  return static_cast<int>(index);
}

Result<Content> PrepareObj(std::string_view text, const MeshLimits& limits) {
  if (text.find('\0') != text.npos) {
    return MakeError(MeshFormat::kObj, "it is not a text file");
  }
  Content content{text};
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
          return MakeError(MeshFormat::kObj, "a face names no vertex");
        }
        ++corners;
        content.corners.push_back(*vertex);
        content.filtered += fmt::format(" {}", *vertex + 1);
      }
      if (corners < 3) {
        return MakeError(MeshFormat::kObj,
                         fmt::format("it has a face with {} corners", corners));
      }
      triangles += corners - 2;
      content.filtered += '\n';
    }
    GRASPDB_TRY_VOID(CheckCounts(vertices, triangles, limits));
  }
  if (triangles == 0) return MakeError(MeshFormat::kObj, "it has no faces");
  for (const int vertex : content.corners) {
    if (vertex >= vertices) {
      return MakeError(MeshFormat::kObj,
                       "a face names a vertex that does not exist");
    }
  }
  return content;
}

// ---- STL

std::size_t CountWord(std::string_view text, std::string_view word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != text.npos;
       at = text.find(word, at + word.size())) {
    ++count;
  }
  return count;
}

Result<Content> PrepareAsciiStl(std::string_view text,
                                const MeshLimits& limits) {
  const std::size_t facets = CountWord(text, "endfacet");
  GRASPDB_TRY_VOID(CheckCounts(0, static_cast<int64_t>(facets), limits));
  if (facets == 0) return MakeError(MeshFormat::kStl, "it has no faces");
  if (CountWord(text, "vertex") != 3 * facets ||
      CountWord(text, "endsolid") == 0) {
    return MakeError(MeshFormat::kStl,
                     "it is truncated or has facets that are no triangles");
  }
  return Content{text};
}

Result<Content> PrepareStl(std::string_view bytes, const MeshLimits& limits) {
  const std::span span(reinterpret_cast<const uint8_t*>(bytes.data()),
                       bytes.size());
  if (!IsBinaryStl(span) && Trim(bytes).starts_with("solid") &&
      bytes.find("facet") != bytes.npos) {
    return PrepareAsciiStl(bytes, limits);
  }
  if (bytes.size() < kBinaryStlHeader) {
    return MakeError(MeshFormat::kStl,
                     "it neither starts with \"solid\" nor has the 84 bytes of "
                     "a binary header");
  }
  uint32_t count = 0;
  static_assert(std::endian::native == std::endian::little);
  std::memcpy(&count, bytes.data() + 80, sizeof(count));
  const std::size_t size = kBinaryStlHeader + kBinaryStlTriangle * count;
  if (count == 0 || size > bytes.size()) {
    return MakeError(MeshFormat::kStl,
                     fmt::format("its header announces {} triangles, which "
                                 "take {} bytes; it has {}",
                                 count, size, bytes.size()));
  }
  GRASPDB_TRY_VOID(CheckCounts(0, count, limits));
  return Content{bytes.substr(0, size)};
}

// ---- PLY: every value that the header announces must be there.

struct PlyProperty {
  std::string name;
  std::size_t size{0};        // Bytes of a value.
  std::size_t count_size{0};  // Bytes of a list's count; 0 for a scalar.
};

struct PlyElement {
  std::string name;
  int64_t count{0};
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  std::string format;
  std::vector<PlyElement> elements;
};

constexpr std::size_t kMostPlyHeaderLines = 1000;

std::size_t GetPlySize(std::string_view type) {
  static constexpr std::pair<std::string_view, std::size_t> kSizes[] = {
      {"char", 1},  {"int8", 1},    {"uchar", 1},  {"uint8", 1},
      {"short", 2}, {"int16", 2},   {"ushort", 2}, {"uint16", 2},
      {"int", 4},   {"int32", 4},   {"uint", 4},   {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  for (const auto& [name, size] : kSizes) {
    if (type == name) return size;
  }
  return 0;
}

// Reads the header and leaves the body in the text; nothing when malformed.
std::optional<PlyHeader> TakePlyHeader(std::string_view& text) {
  PlyHeader header;
  if (Trim(TakeLine(text)) != "ply") return std::nullopt;
  for (std::size_t i = 0; i < kMostPlyHeaderLines && !text.empty(); ++i) {
    std::string_view line = TakeLine(text);
    const std::string_view keyword = TakeWord(line);
    if (keyword == "end_header") return header;
    if (keyword == "format") {
      header.format = TakeWord(line);
    } else if (keyword == "element") {
      PlyElement element{std::string(TakeWord(line)), 0, {}};
      const std::string_view count = TakeWord(line);
      const auto [end, error] = std::from_chars(
          count.data(), count.data() + count.size(), element.count);
      if (error != std::errc() || element.count < 0 ||
          end != count.data() + count.size()) {
        return std::nullopt;
      }
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (header.elements.empty()) return std::nullopt;
      PlyProperty property;
      std::string_view type = TakeWord(line);
      if (type == "list") {
        property.count_size = GetPlySize(TakeWord(line));
        if (property.count_size == 0) return std::nullopt;
        type = TakeWord(line);
      }
      property.size = GetPlySize(type);
      property.name = TakeWord(line);
      if (property.size == 0 || property.name.empty()) return std::nullopt;
      header.elements.back().properties.push_back(std::move(property));
    } else if (keyword != "comment" && keyword != "obj_info") {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

// Walks over the values of a PLY body without keeping them.
class PlyBody {
 public:
  PlyBody(std::string_view body, std::string_view format)
      : rest_(body),
        ascii_(format == "ascii"),
        big_endian_(format == "binary_big_endian") {}

  bool Skip(std::size_t size, int64_t count) {
    if (ascii_) {
      for (int64_t i = 0; i < count; ++i) {
        if (TakeWord(rest_).empty()) return false;
      }
      return true;
    }
    if (count > static_cast<int64_t>(rest_.size() / size)) return false;
    rest_.remove_prefix(size * static_cast<std::size_t>(count));
    return true;
  }

  // A list's count; -1 when there is none.
  int64_t TakeCount(std::size_t size) {
    int64_t count = 0;
    if (ascii_) {
      const std::string_view word = TakeWord(rest_);
      const auto [end, error] =
          std::from_chars(word.data(), word.data() + word.size(), count);
      return error == std::errc() ? count : -1;
    }
    if (rest_.size() < size) return -1;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t at = big_endian_ ? i : size - 1 - i;
      count = count << 8 | static_cast<uint8_t>(rest_[at]);
    }
    rest_.remove_prefix(size);
    return count;
  }

  // Whether so many values could be there at all.
  bool CouldHold(const PlyElement& element) const {
    std::size_t row = 0;
    for (const PlyProperty& property : element.properties) {
      const std::size_t size =
          property.count_size > 0 ? property.count_size : property.size;
      row += ascii_ ? 1 : size;
    }
    return row > 0 && element.count <= static_cast<int64_t>(rest_.size() / row);
  }

 private:
  std::string_view rest_;
  bool ascii_;
  bool big_endian_;
};

bool HasProperty(const PlyElement& element, std::string_view name, bool list) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const PlyProperty& property) {
                       return property.name == name &&
                              (property.count_size > 0) == list;
                     });
}

Result<Content> PreparePly(std::string_view bytes, const MeshLimits& limits) {
  const auto fail = [](const std::string& what) {
    return MakeError(MeshFormat::kPly, what);
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
        if (!HasProperty(element, name, false)) {
          return fail("its vertices lack a coordinate");
        }
      }
    } else if (is_face) {
      triangles += element.count;
      if (!HasProperty(element, "vertex_indices", true) &&
          !HasProperty(element, "vertex_index", true)) {
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
  Content content{bytes};
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

Result<Content> Prepare(std::string_view bytes, MeshFormat format,
                        const MeshLimits& limits) {
  switch (format) {
    case MeshFormat::kObj:
      return PrepareObj(bytes, limits);
    case MeshFormat::kStl:
      return PrepareStl(bytes, limits);
    case MeshFormat::kPly:
      break;
  }
  return PreparePly(bytes, limits);
}

// ---- Decoding

// There is no file: whatever a mesh refers to does not exist.
class NoFiles : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

// Unregisters every importer but the one for the extension, so that no other
// one feels invited by the content.
void KeepOneImporter(Assimp::Importer& importer, std::string_view extension) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    std::string_view known = importer.GetImporterInfo(i)->mFileExtensions;
    bool keep = false;
    for (auto word = TakeWord(known); !word.empty(); word = TakeWord(known)) {
      keep = keep || word == extension;
    }
    if (keep) continue;
    Assimp::BaseImporter* other = importer.GetImporter(i);
    importer.UnregisterLoader(other);
    delete other;
  }
}

std::string MakePrintable(std::string_view text) {
  std::string printable(text.substr(0, 120));
  for (char& c : printable) {
    if (!std::isprint(static_cast<unsigned char>(c))) c = '?';
  }
  return printable;
}

// Numbers the decoder's vertices by position, equal ones alike.
std::vector<int> JoinPositions(std::span<const aiVector3D> vertices) {
  struct Hash {
    std::size_t operator()(const std::array<float, 3>& p) const {
      uint64_t hash = 0;
      for (const float x : p) {
        hash = (hash ^ std::bit_cast<uint32_t>(x)) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
      }
      return hash;
    }
  };
  std::unordered_map<std::array<float, 3>, int, Hash> index;
  std::vector<int> joined;
  for (const aiVector3D& p : vertices) {
    // Adding zero makes of -0 a 0.
    const std::array<float, 3> key{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
    const int next = static_cast<int>(index.size());
    joined.push_back(index.try_emplace(key, next).first->second);
  }
  return joined;
}

// Cuts a polygon of indices into triangles of the same winding, ear by ear; a
// convex one into a fan about its first corner. A polygon without area or that
// crosses itself comes out somehow.
void CutPolygon(const std::vector<aiVector3D>& vertices,
                std::vector<int> polygon, std::vector<Eigen::Vector3i>* faces) {
  const auto at = [&vertices](int v) {
    return Eigen::Vector3d(vertices[v].x, vertices[v].y, vertices[v].z);
  };
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Eigen::Vector3d a = at(polygon[0]);
    normal += (at(polygon[i - 1]) - a).cross(at(polygon[i]) - a);
  }
  // Positive where p lies to the left of the way from a to b.
  const auto side = [&](int a, int b, int p) {
    return (at(b) - at(a)).cross(at(p) - at(a)).dot(normal);
  };
  const auto is_ear = [&](std::size_t i) {
    const std::size_t n = polygon.size();
    const int a = polygon[(i + n - 1) % n];
    const int b = polygon[i];
    const int c = polygon[(i + 1) % n];
    if (side(a, b, c) <= 0.0) return false;
    return std::none_of(polygon.begin(), polygon.end(), [&](int p) {
      return p != a && p != b && p != c && side(a, b, p) >= 0.0 &&
             side(b, c, p) >= 0.0 && side(c, a, p) >= 0.0;
    });
  };
  std::size_t start = 1;
  while (polygon.size() > 3) {
    const std::size_t n = polygon.size();
    std::size_t ear = start % n;
    for (std::size_t i = 0; i < n; ++i) {
      if (is_ear((start + i) % n)) {
        ear = (start + i) % n;
        break;
      }
    }
    faces->emplace_back(polygon[(ear + n - 1) % n], polygon[ear],
                        polygon[(ear + 1) % n]);
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(ear));
    start = std::max<std::size_t>(ear, 1);
  }
  faces->emplace_back(polygon[0], polygon[1], polygon[2]);
}

// All vertices and triangles of the scene, in its order.
struct Soup {
  std::vector<aiVector3D> vertices;
  std::vector<Eigen::Vector3i> faces;
};

Result<Soup> CollectSoup(const aiScene& scene, MeshFormat format) {
  Soup soup;
  for (const aiMesh* mesh : std::span(scene.mMeshes, scene.mNumMeshes)) {
    const int offset = static_cast<int>(soup.vertices.size());
    for (const aiVector3D& p : std::span(mesh->mVertices, mesh->mNumVertices)) {
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
        return MakeError(format, "it has a coordinate that is not finite");
      }
      soup.vertices.push_back(p);
    }
    for (const aiFace& face : std::span(mesh->mFaces, mesh->mNumFaces)) {
      if (face.mNumIndices < 3) {
        return MakeError(format, fmt::format("it has a face with {} corners",
                                             face.mNumIndices));
      }
      std::vector<int> polygon;
      for (const unsigned v : std::span(face.mIndices, face.mNumIndices)) {
        if (v >= mesh->mNumVertices) {
          return MakeError(format, "a face names a vertex that does not exist");
        }
        polygon.push_back(offset + static_cast<int>(v));
      }
      CutPolygon(soup.vertices, std::move(polygon), &soup.faces);
    }
  }
  if (soup.faces.empty()) return MakeError(format, "it has no faces");
  return soup;
}

// @param vertex  The file's vertex that each of the decoder's stands for.
TriangleMesh MakeMesh(const Soup& soup, const std::vector<int>& vertex,
                      double metres_per_unit) {
  const int count = 1 + *std::max_element(vertex.begin(), vertex.end());
  std::vector<const aiVector3D*> used(count, nullptr);
  for (const Eigen::Vector3i& face : soup.faces) {
    for (const int v : face) used[vertex[v]] = &soup.vertices[v];
  }
  std::vector<int> index(count);
  std::vector<Eigen::Vector3d> vertices;
  for (int v = 0; v < count; ++v) {
    index[v] = static_cast<int>(vertices.size());
    if (used[v] == nullptr) continue;
    const aiVector3D& p = *used[v];
    vertices.push_back(metres_per_unit * Eigen::Vector3d(p.x, p.y, p.z));
  }
  std::vector<Eigen::Vector3i> triangles;
  for (const Eigen::Vector3i& face : soup.faces) {
    triangles.emplace_back(index[vertex[face[0]]], index[vertex[face[1]]],
                           index[vertex[face[2]]]);
  }
  return TriangleMesh(std::move(vertices), std::move(triangles));
}

Result<TriangleMesh> Assemble(const aiScene& scene, MeshFormat format,
                              const Content& content, double metres_per_unit) {
  GRASPDB_TRY(soup, CollectSoup(scene, format));
  std::vector<int> vertex;
  switch (format) {
    case MeshFormat::kObj:
      vertex = content.corners;
      break;
    case MeshFormat::kStl:
      vertex = JoinPositions(soup.vertices);
      break;
    case MeshFormat::kPly:
      vertex.resize(soup.vertices.size());
      std::iota(vertex.begin(), vertex.end(), 0);
      break;
  }
  if (vertex.size() != soup.vertices.size()) {
    return MakeError(format, "its faces do not match its vertices");
  }
  return MakeMesh(soup, vertex, metres_per_unit);
}

Result<TriangleMesh> DecodeContent(const Content& content, MeshFormat format,
                                   double metres_per_unit) {
  const std::string extension = ToLower(GetName(format));
  Assimp::Importer importer;
  importer.SetIOHandler(new NoFiles);  // The importer owns it.
  KeepOneImporter(importer, extension);
  const aiScene* scene = importer.ReadFileFromMemory(
      content.bytes().data(), content.bytes().size(), 0, extension.c_str());
  if (scene == nullptr) {
    return MakeError(format, MakePrintable(importer.GetErrorString()));
  }
  return Assemble(*scene, format, content, metres_per_unit);
}

}  // namespace

Result<TriangleMesh> ReadMesh(std::span<const uint8_t> bytes, MeshFormat format,
                              double metres_per_unit,
                              const MeshLimits& limits) {
  GRASPDB_EXPECTS(metres_per_unit > 0.0 && std::isfinite(metres_per_unit));
  if (bytes.empty()) return MakeError(format, "it is empty");
  if (static_cast<int64_t>(bytes.size()) > limits.max_bytes) {
    return Error{ErrorCode::kTooLarge,
                 fmt::format("the mesh has {} bytes; the limit is {}",
                             bytes.size(), limits.max_bytes),
                 "Decimate the mesh first.", "mesh"};
  }
  GRASPDB_TRY(content, Prepare(ToText(bytes), format, limits));
  try {
    return DecodeContent(content, format, metres_per_unit);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return MakeError(format, MakePrintable(error.what()));
  }
}

}  // namespace graspdb
