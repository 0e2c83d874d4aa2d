#include "engine/admission/mesh_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <limits>
#include <new>
#include <numeric>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>
#include <fmt/core.h>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>

#include "engine/admission/mesh_content.h"
#include "engine/admission/text_scanner.h"
#include "engine/base/contract.h"

namespace graspdb {
namespace {

// Of a coordinate, in diagonals of the mesh.
constexpr double kMostRounding = 1e-4;

std::string_view ToText(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Result<MeshContent> Prepare(std::string_view bytes, MeshFormat format,
                            const MeshLimits& limits) {
  switch (format) {
    case MeshFormat::kObj:
      return PrepareObj(bytes, limits);
    case MeshFormat::kOff:
      return PrepareOff(bytes, limits);
    case MeshFormat::kStl:
      return PrepareStl(bytes, limits);
    case MeshFormat::kPly:
      return PreparePly(bytes, limits);
    case MeshFormat::kGltf:
    case MeshFormat::kGlb:
    case MeshFormat::kDae:
      break;
    case MeshFormat::kPcd:
    case MeshFormat::kXyz:
      return MakeFormatError(format, "it holds points, not faces");
  }
  return MeshContent{bytes};
}

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

// Numbers vertices by position, equal ones alike.
std::vector<int> JoinPositions(const std::vector<Eigen::Vector3d>& vertices) {
  struct Hash {
    std::size_t operator()(const std::array<double, 3>& p) const {
      uint64_t hash = 0;
      for (const double x : p) {
        hash = (hash ^ std::bit_cast<uint64_t>(x)) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
      }
      return hash;
    }
  };
  std::unordered_map<std::array<double, 3>, int, Hash> index;
  std::vector<int> joined;
  for (const Eigen::Vector3d& p : vertices) {
    // Adding zero makes of -0 a 0.
    const std::array<double, 3> key{p.x() + 0.0, p.y() + 0.0, p.z() + 0.0};
    const int next = static_cast<int>(index.size());
    joined.push_back(index.try_emplace(key, next).first->second);
  }
  return joined;
}

// Cuts a polygon of indices into triangles of the same winding, ear by ear; a
// convex one into a fan about its first corner. A polygon without area or that
// crosses itself comes out somehow.
void CutPolygon(const std::vector<Eigen::Vector3d>& vertices,
                std::vector<int> polygon, std::vector<Eigen::Vector3i>* faces) {
  const auto at = [&vertices](int v) { return vertices[v]; };
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

// All vertices and triangles of a scene, in its order, in the scene's frame.
class Soup {
 public:
  Soup(const aiScene& scene, MeshFormat format, const MeshLimits& limits)
      : scene_(scene), format_(format), limits_(limits) {}

  Result<void> Collect(const Eigen::Affine3d& X_SO) {
    GRASPDB_TRY_VOID(AddNode(*scene_.mRootNode, X_SO));
    if (!faces_.empty()) return {};
    return MakeFormatError(
        format_, skipped_ ? "it has no faces, only points" : "it has no faces");
  }

  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }
  const std::vector<Eigen::Vector3i>& faces() const { return faces_; }

 private:
  Result<void> AddNode(const aiNode& node, const Eigen::Affine3d& X_SP) {
    const Eigen::Affine3d X_SN = X_SP * ToEigen(node.mTransformation);
    for (const unsigned m : std::span(node.mMeshes, node.mNumMeshes)) {
      GRASPDB_TRY_VOID(AddMesh(*scene_.mMeshes[m], X_SN));
    }
    for (const aiNode* child : std::span(node.mChildren, node.mNumChildren)) {
      GRASPDB_TRY_VOID(AddNode(*child, X_SN));
    }
    return {};
  }

  Result<void> AddMesh(const aiMesh& mesh, const Eigen::Affine3d& X_SN) {
    const int offset = static_cast<int>(vertices_.size());
    GRASPDB_TRY_VOID(CheckCounts(
        static_cast<int64_t>(vertices_.size()) + mesh.mNumVertices,
        static_cast<int64_t>(faces_.size()) + mesh.mNumFaces, limits_));
    for (const aiVector3D& p : std::span(mesh.mVertices, mesh.mNumVertices)) {
      const Eigen::Vector3d p_S = X_SN * Eigen::Vector3d(p.x, p.y, p.z);
      if (!p_S.allFinite()) {
        return MakeFormatError(format_,
                               "it has a coordinate that is not finite");
      }
      vertices_.push_back(p_S);
    }
    const bool mirrored = X_SN.linear().determinant() < 0.0;
    for (const aiFace& face : std::span(mesh.mFaces, mesh.mNumFaces)) {
      if (face.mNumIndices < 3 && IsScene(format_)) {
        skipped_ = true;  // Points and lines are no surface.
        continue;
      }
      if (face.mNumIndices < 3) {
        return MakeFormatError(format_, fmt::format("it has a face with {} "
                                                    "corners",
                                                    face.mNumIndices));
      }
      std::vector<int> polygon;
      for (const unsigned v : std::span(face.mIndices, face.mNumIndices)) {
        if (v >= mesh.mNumVertices) {
          return MakeFormatError(format_,
                                 "a face names a vertex that does not exist");
        }
        polygon.push_back(offset + static_cast<int>(v));
      }
      if (mirrored) std::reverse(polygon.begin(), polygon.end());
      CutPolygon(vertices_, std::move(polygon), &faces_);
    }
    return CheckCounts(static_cast<int64_t>(vertices_.size()),
                       static_cast<int64_t>(faces_.size()), limits_);
  }

  static Eigen::Affine3d ToEigen(const aiMatrix4x4& m) {
    Eigen::Affine3d X;
    X.matrix() << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2,
        m.c3, m.c4, 0, 0, 0, 1;
    return X;
  }

  const aiScene& scene_;
  const MeshFormat format_;
  const MeshLimits& limits_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Eigen::Vector3i> faces_;
  bool skipped_{false};
};

// @param vertex  The file's vertex that each of the soup's stands for.
TriangleMesh MakeMesh(const Soup& soup, const std::vector<int>& vertex) {
  const int count = 1 + *std::max_element(vertex.begin(), vertex.end());
  std::vector<const Eigen::Vector3d*> used(count, nullptr);
  for (const Eigen::Vector3i& face : soup.faces()) {
    for (const int v : face) used[vertex[v]] = &soup.vertices()[v];
  }
  std::vector<int> index(count);
  std::vector<Eigen::Vector3d> vertices;
  for (int v = 0; v < count; ++v) {
    index[v] = static_cast<int>(vertices.size());
    if (used[v] != nullptr) vertices.push_back(*used[v]);
  }
  std::vector<Eigen::Vector3i> triangles;
  for (const Eigen::Vector3i& face : soup.faces()) {
    triangles.emplace_back(index[vertex[face[0]]], index[vertex[face[1]]],
                           index[vertex[face[2]]]);
  }
  return TriangleMesh(std::move(vertices), std::move(triangles));
}

// The file's vertex that each of the soup's stands for.
std::vector<int> FindFileVertices(const Soup& soup, MeshFormat format,
                                  const MeshContent& content) {
  if (format == MeshFormat::kObj || format == MeshFormat::kOff) {
    return content.corners;
  }
  if (format != MeshFormat::kPly) return JoinPositions(soup.vertices());
  std::vector<int> same(soup.vertices().size());
  std::iota(same.begin(), same.end(), 0);
  return same;
}

// What the decoder's unit is to be multiplied with. It has a Collada file's
// unit as the scale of the root, and glTF is in metres.
double CalcScale(const aiScene& scene, MeshFormat format,
                 std::optional<double> metres_per_unit) {
  if (!metres_per_unit) return 1.0;
  if (format != MeshFormat::kDae) return *metres_per_unit;
  const aiMatrix4x4& root = scene.mRootNode->mTransformation;
  const double unit = std::hypot(root.a1, root.b1, root.c1);
  return unit > 0.0 ? *metres_per_unit / unit : *metres_per_unit;
}

Result<TriangleMesh> DecodeContent(const MeshContent& content,
                                   MeshFormat format,
                                   std::optional<double> metres_per_unit,
                                   const MeshLimits& limits) {
  const std::string extension =
      ToLower(GetName(format == MeshFormat::kOff ? MeshFormat::kObj : format));
  Assimp::Importer importer;
  importer.SetIOHandler(new NoFiles);  // The importer owns it.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  KeepOneImporter(importer, extension);
  const aiScene* scene = importer.ReadFileFromMemory(
      content.bytes().data(), content.bytes().size(), 0, extension.c_str());
  if (scene == nullptr || scene->mRootNode == nullptr) {
    return MakeFormatError(format, MakePrintable(importer.GetErrorString()));
  }
  Soup soup(*scene, format, limits);
  Eigen::Affine3d X_SO = Eigen::Affine3d::Identity();
  X_SO.linear() *= CalcScale(*scene, format, metres_per_unit);
  GRASPDB_TRY_VOID(soup.Collect(X_SO));
  const std::vector<int> vertex = FindFileVertices(soup, format, content);
  if (vertex.size() != soup.vertices().size()) {
    return MakeFormatError(format, "its faces do not match its vertices");
  }
  TriangleMesh mesh = MakeMesh(soup, vertex);
  const double farthest = std::max(mesh.box_min().cwiseAbs().maxCoeff(),
                                   mesh.box_max().cwiseAbs().maxCoeff());
  // assimp keeps single-precision coordinates.
  if (mesh.diagonal() > 0.0 &&
      farthest * std::numeric_limits<float>::epsilon() >
          kMostRounding * mesh.diagonal()) {
    return MakeFormatError(
        format,
        "it lies so far from its origin that its shape is lost in "
        "rounding; move it there");
  }
  return mesh;
}

}  // namespace

Result<TriangleMesh> ReadMesh(std::span<const uint8_t> bytes, MeshFormat format,
                              std::optional<double> metres_per_unit,
                              const MeshLimits& limits) {
  GRASPDB_EXPECTS(!metres_per_unit ||
                  (*metres_per_unit > 0.0 && std::isfinite(*metres_per_unit)));
  GRASPDB_TRY_VOID(CheckSize(bytes, format, limits));
  GRASPDB_TRY(content, Prepare(ToText(bytes), format, limits));
  try {
    return DecodeContent(content, format, metres_per_unit, limits);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return MakeFormatError(format, MakePrintable(error.what()));
  }
}

}  // namespace graspdb
