#include "engine/admission/mesh_reader.h"

#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "engine/base/contract.h"
#include "tests/support/mesh_files.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

using ::testing::HasSubstr;

// A tetrahedron whose coordinates are exact in single precision.
TriangleMesh MakeTetrahedron() {
  return TriangleMesh({{0, 0, 0}, {0.125, 0, 0}, {0, 0.125, 0}, {0, 0, 0.125}},
                      {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
}

Result<TriangleMesh> Read(const FileBytes& bytes, MeshFormat format) {
  return ReadMesh(bytes, format, 1.0, MeshLimits{});
}

Result<TriangleMesh> ReadObj(const std::string& text) {
  return Read(ToBytes(text), MeshFormat::kObj);
}

FileBytes MakePly(const std::string& header, const std::string& body) {
  return ToBytes("ply\nformat ascii 1.0\n" + header + "end_header\n" + body);
}

constexpr char kPlyVertex[] =
    "property float x\nproperty float y\nproperty float z\n";

TEST(MeshReader, ReadsTheSameMeshFromEveryEncoding) {
  const TriangleMesh cylinder = workshop::MakeCylinder(0.04, 0.1, 24, 4);
  for (const auto& [name, bytes] : MakeEveryFile(cylinder)) {
    SCOPED_TRACE(name);
    const auto format = GuessMeshFormat(bytes, name);
    ASSERT_TRUE(format.has_value());
    const auto mesh = Read(bytes, *format);
    ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
    ASSERT_EQ(mesh->num_triangles(), cylinder.num_triangles());
    EXPECT_EQ(mesh->num_vertices(), cylinder.num_vertices());
    for (int f = 0; f < cylinder.num_triangles(); ++f) {
      for (int k = 0; k < 3; ++k) {
        // Single precision: 2^-24 of 0.05 m.
        EXPECT_LT((mesh->corner(f, k) - cylinder.corner(f, k)).norm(), 1e-8);
      }
    }
    if (*format != MeshFormat::kStl && !IsScene(*format)) {
      EXPECT_EQ(mesh->triangles(), cylinder.triangles());
    }
  }
}

TEST(MeshReader, NumbersTheCornersOfAnStlByFirstMention) {
  const auto mesh = Read(MakeBinaryStl(MakeTetrahedron()), MeshFormat::kStl);
  ASSERT_TRUE(mesh.has_value());
  // The faces 0 2 1, 0 1 3, 1 2 3, 0 3 2 mention 0, 2, 1, 3 in this order.
  EXPECT_EQ(mesh->vertices(),
            (std::vector<Eigen::Vector3d>{
                {0, 0, 0}, {0, 0.125, 0}, {0.125, 0, 0}, {0, 0, 0.125}}));
  EXPECT_EQ(mesh->triangles(),
            (std::vector<Eigen::Vector3i>{
                {0, 1, 2}, {0, 2, 3}, {2, 1, 3}, {0, 3, 1}}));
}

TEST(MeshReader, KeepsTheOrderOfAnObjWhateverItsGroupsAndMaterials) {
  const auto mesh = ReadObj(
      "# a comment\r\nmtllib none.mtl\no first\n"
      "v 0 0 0\nv 1 0 0\nv 0 1 0 \nvt 0 0\nvn 0 0 1\n"
      "usemtl a\ng one\nf 1/1/1 3/1/1 2/1/1\n"
      "o second\nusemtl b\nv 0 0 1\nf -4//1 -3//1 -1//1\n"
      "o first\nusemtl a\ng one\ns 1\nf 2 3 \\\n 4\n"
      "usemtl b\n  f 1 4 3\n");
  ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
  EXPECT_EQ(mesh->vertices(), (std::vector<Eigen::Vector3d>{
                                  {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(mesh->triangles(),
            (std::vector<Eigen::Vector3i>{
                {0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}));
}

TEST(MeshReader, KeepsVerticesApartThatTheFileKeepsApart) {
  const auto mesh = ReadObj(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 0 0 1\n"
      "f 1 2 3\nf 4 3 5\n");
  ASSERT_TRUE(mesh.has_value());
  EXPECT_EQ(mesh->num_vertices(), 5);
  EXPECT_EQ(mesh->triangles()[1], Eigen::Vector3i(3, 2, 4));
}

TEST(MeshReader, LeavesOutVerticesThatNoFaceUses) {
  const auto mesh =
      ReadObj("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 5 5 5\nv 0 1 0\nf 2 3 5\n");
  ASSERT_TRUE(mesh.has_value());
  EXPECT_EQ(mesh->num_vertices(), 3);
  EXPECT_EQ(mesh->triangles()[0], Eigen::Vector3i(0, 1, 2));
}

TEST(MeshReader, CutsPolygonsInPlace) {
  // A triangle, a concave L of area 3, and another triangle.
  const auto mesh = ReadObj(
      "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 1\n"
      "f 1 2 7\nf 1 2 3 4 5 6\nf 2 3 7\n");
  ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
  ASSERT_EQ(mesh->num_triangles(), 6);
  EXPECT_EQ(mesh->triangles()[0], Eigen::Vector3i(0, 1, 6));
  EXPECT_EQ(mesh->triangles()[5], Eigen::Vector3i(1, 2, 6));
  double area = 0.0;
  for (int f = 1; f < 5; ++f) {
    area += mesh->area(f);
    EXPECT_EQ(mesh->normal(f), Eigen::Vector3d::UnitZ());
  }
  EXPECT_NEAR(area, 3.0, 1e-12);
}

TEST(MeshReader, CutsAConvexPolygonIntoAFan) {
  const auto mesh =
      ReadObj("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n");
  ASSERT_TRUE(mesh.has_value());
  EXPECT_EQ(mesh->triangles(),
            (std::vector<Eigen::Vector3i>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

TEST(MeshReader, CutsPolygonsWithoutAreaSomehow) {
  const auto mesh = ReadObj(
      "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nf 1 2 3 4\n"
      "f 1 4 2 5 3\n");
  ASSERT_TRUE(mesh.has_value());
  EXPECT_EQ(mesh->num_triangles(), 5);
}

TEST(MeshReader, TakesBinaryValuesForNoWhiteSpace) {
  // The body's first byte, in a number as small as the rest of it permits.
  for (const uint8_t byte : std::string_view("\0\t\n\r ", 5)) {
    for (const bool big_endian : {false, true}) {
      uint8_t raw[4] = {0, 0, 0, 0x3d};
      raw[big_endian ? 3 : 0] = byte;
      float x = 0.0f;
      std::memcpy(&x, raw, 4);
      const TriangleMesh triangle({{x, x, x}, {0.5, 0, 0}, {0, 0.5, 0}},
                                  {{0, 1, 2}});
      const auto mesh =
          Read(MakeBinaryPly(triangle, big_endian), MeshFormat::kPly);
      ASSERT_TRUE(mesh.has_value()) << int{byte} << mesh.error().message;
      EXPECT_TRUE(*mesh == triangle) << int{byte};
    }
  }
}

TEST(MeshReader, RefusesAMeshWhoseShapeIsLostInRounding) {
  const auto tetrahedron_at = [](const std::string& x, const std::string& x1) {
    return ReadObj("v " + x + " 0 0\nv " + x1 + " 0 0\nv " + x + " 0.1 0\nv " +
                   x + " 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  };
  EXPECT_TRUE(tetrahedron_at("10", "10.1"));
  const auto far = tetrahedron_at("1000", "1000.1");
  ASSERT_FALSE(far);
  EXPECT_THAT(far.error().message, testing::HasSubstr("rounding"));
}

TEST(MeshReader, MultipliesByTheUnit) {
  const auto mesh = ReadMesh(MakeObj(MakeTetrahedron()), MeshFormat::kObj,
                             0.001, MeshLimits{});
  ASSERT_TRUE(mesh.has_value());
  EXPECT_EQ(mesh->vertices()[1], Eigen::Vector3d(0.001 * 0.125, 0, 0));
  EXPECT_THROW((void)ReadMesh(MakeObj(MakeTetrahedron()), MeshFormat::kObj, 0,
                              MeshLimits{}),
               ContractViolation);
}

TEST(MeshReader, AcceptsBytesBehindABinaryStl) {
  FileBytes bytes = MakeBinaryStl(MakeTetrahedron());
  std::memcpy(bytes.data(), "solid", 5);  // As some programs write.
  EXPECT_TRUE(Read(bytes, MeshFormat::kStl).has_value());
  std::memcpy(bytes.data(), "Exported", 8);
  bytes.resize(bytes.size() + 7);
  const auto mesh = Read(bytes, MeshFormat::kStl);
  ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
  EXPECT_EQ(mesh->num_triangles(), 4);
}

TEST(MeshReader, RefusesWhatIsNoMeshAndNamesTheFormat) {
  const std::string faces =
      "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string three = std::string("element vertex 3\n") + kPlyVertex;
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  struct {
    MeshFormat format;
    FileBytes bytes;
    const char* words;
  } const cases[] = {
      {MeshFormat::kObj, {}, "OBJ: it is empty"},
      {MeshFormat::kStl, {}, "STL: it is empty"},
      {MeshFormat::kPly, {}, "PLY: it is empty"},
      {MeshFormat::kObj, ToBytes("<html>hello</html>"), "no faces"},
      {MeshFormat::kStl, ToBytes("<html>hello</html>"), "84 bytes"},
      {MeshFormat::kPly, ToBytes("<html>hello</html>"), "header"},
      {MeshFormat::kObj, MakeBinaryStl(MakeTetrahedron()), "not a text file"},
      {MeshFormat::kObj, MakeAsciiPly(MakeTetrahedron()), "no faces"},
      {MeshFormat::kPly, MakeObj(MakeTetrahedron()), "header"},
      {MeshFormat::kStl, MakeObj(MakeTetrahedron()), "bytes"},
      {MeshFormat::kObj, ToBytes("v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "no faces"},
      {MeshFormat::kObj, ToBytes("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
       "does not exist"},
      {MeshFormat::kObj, ToBytes("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"),
       "names no vertex"},
      {MeshFormat::kObj, ToBytes("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n"),
       "names no vertex"},
      {MeshFormat::kObj, ToBytes("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n"),
       "names no vertex"},
      {MeshFormat::kObj, ToBytes("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n"),
       "2 corners"},
      {MeshFormat::kObj, ToBytes("v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n"),
       "not finite"},
      {MeshFormat::kObj, ToBytes("v 0 0 0\nv 1 inf 0\nv 0 1 0\nf 1 2 3\n"),
       "not finite"},
      {MeshFormat::kObj, ToBytes("v 0 0 0\nv 1 1e99 0\nv 0 1 0\nf 1 2 3\n"),
       "not finite"},
      {MeshFormat::kPly, MakePly(three + faces, points + "3 0 1 3\n"),
       "does not exist"},
      {MeshFormat::kPly, MakePly(three + faces, points + "3 0 1 -1\n"),
       "does not exist"},
      {MeshFormat::kPly, MakePly(three + faces, points + "4 0 1 2 7\n"),
       "does not exist"},
      {MeshFormat::kPly, MakePly(three + faces, points + "2 0 1\n"),
       "2 corners"},
      {MeshFormat::kPly, MakePly(three, points), "only points"},
      {MeshFormat::kPly, MakePly(three + faces, "0 0 0\n1 0 0\n"), "announces"},
      {MeshFormat::kPly,
       MakePly("element vertex 3\nproperty float x\n" + faces, points),
       "lack a coordinate"},
      {MeshFormat::kPly, MakePly(three + faces, points + "9999999 0 1 2\n"),
       "PLY"},
  };
  for (const auto& [format, bytes, words] : cases) {
    const auto mesh = Read(bytes, format);
    ASSERT_FALSE(mesh.has_value()) << words;
    EXPECT_TRUE(mesh.error().code == ErrorCode::kUnusableInput ||
                mesh.error().code == ErrorCode::kTooLarge);
    EXPECT_THAT(mesh.error().message, HasSubstr(words));
    EXPECT_FALSE(mesh.error().hint.empty());
    if (mesh.error().code == ErrorCode::kUnusableInput) {
      EXPECT_THAT(mesh.error().message, HasSubstr(GetName(format)));
    }
  }
}

TEST(MeshReader, RefusesCoordinatesInStlAndPlyThatAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(),
                          -std::numeric_limits<float>::infinity()}) {
    FileBytes stl = MakeBinaryStl(MakeTetrahedron());
    std::memcpy(stl.data() + 84 + 50 + 12, &bad, 4);  // Second face, x of 0.
    FileBytes ply = MakeBinaryPly(MakeTetrahedron(), false);
    const std::size_t body = ply.size() - 4 * 12 - 4 * 13;
    std::memcpy(ply.data() + body + 16, &bad, 4);  // Second vertex, y.
    for (const auto& [bytes, format] :
         {std::pair(stl, MeshFormat::kStl), {ply, MeshFormat::kPly}}) {
      const auto mesh = Read(bytes, format);
      ASSERT_FALSE(mesh.has_value());
      EXPECT_THAT(mesh.error().message, HasSubstr("not finite"));
    }
  }
}

TEST(MeshReader, RefusesEveryTruncationThatLeavesAnythingOut) {
  for (const auto& [name, bytes] : MakeEveryFile(MakeTetrahedron())) {
    SCOPED_TRACE(name);
    const MeshFormat format = *GuessMeshFormat(bytes, name);
    // The last line's end, and the name behind endsolid, are no loss; a number
    // cut short in ASCII PLY or OBJ is another number.
    // A GLB's indices may be cut by what its buffer's alignment leaves.
    const bool text = name == "a.obj" || name == "ascii.ply";
    const std::size_t spare = name == "ascii.stl" ? 6
                              : name == "a.off"   ? 10
                              : name == "a.dae"   ? 1
                              : text              ? 2
                                                  : 0;
    for (std::size_t size = 0; size + spare < bytes.size(); ++size) {
      const auto mesh =
          Read(FileBytes(bytes.begin(), bytes.begin() + size), format);
      if (format == MeshFormat::kObj) {
        // Nothing in an OBJ tells how much there should be.
        EXPECT_TRUE(!mesh || mesh->num_triangles() < 4) << size;
      } else {
        EXPECT_FALSE(mesh.has_value()) << size;
      }
    }
  }
}

TEST(MeshReader, NamesTheLimitThatIsExceeded) {
  const TriangleMesh box = workshop::MakeBox({0.1, 0.1, 0.1}, 4);
  for (const auto& [name, bytes] : MakeEveryFile(box)) {
    SCOPED_TRACE(name);
    const MeshFormat format = *GuessMeshFormat(bytes, name);
    MeshLimits limits;
    limits.max_triangles = box.num_triangles();
    limits.max_bytes = static_cast<int64_t>(bytes.size());
    EXPECT_TRUE(ReadMesh(bytes, format, 1.0, limits).has_value());
    --limits.max_triangles;
    auto mesh = ReadMesh(bytes, format, 1.0, limits);
    ASSERT_FALSE(mesh.has_value());
    EXPECT_EQ(mesh.error().code, ErrorCode::kTooLarge);
    EXPECT_THAT(mesh.error().message, HasSubstr("191"));
    limits = MeshLimits{};
    limits.max_bytes = static_cast<int64_t>(bytes.size()) - 1;
    mesh = ReadMesh(bytes, format, 1.0, limits);
    ASSERT_FALSE(mesh.has_value());
    EXPECT_EQ(mesh.error().code, ErrorCode::kTooLarge);
  }
}

int64_t GetPeakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss * int64_t{1024};
}

TEST(MeshReader, SpendsNoMemoryOnHeadersThatLie) {
  const int64_t before = GetPeakMemory();
  const std::string faces =
      "element face 4\nproperty list uchar int vertex_indices\n";
  for (const char* count : {"4000000", "4000000000", "9223372036854775807",
                            "99999999999999999999", "-1", "399999"}) {
    const FileBytes ply = MakePly(
        std::string("element vertex ") + count + "\n" + kPlyVertex + faces,
        "0 0 0\n");
    EXPECT_FALSE(Read(ply, MeshFormat::kPly).has_value()) << count;
    const FileBytes other =
        MakePly(std::string("element other ") + count + "\n" + kPlyVertex +
                    "element vertex 3\n" + kPlyVertex + faces,
                "0 0 0\n");
    EXPECT_FALSE(Read(other, MeshFormat::kPly).has_value()) << count;
    const FileBytes empty_rows =
        MakePly(std::string("element vertex 3\n") + kPlyVertex + faces +
                    "element other " + count + "\n",
                "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n3 0 1 2\n3 0 1 2\n");
    EXPECT_FALSE(Read(empty_rows, MeshFormat::kPly).has_value()) << count;
  }
  for (const uint32_t count : {300'000u, 85'899'346u, 4'294'967'295u}) {
    FileBytes stl = MakeBinaryStl(MakeTetrahedron());
    std::memcpy(stl.data() + 80, &count, 4);
    EXPECT_FALSE(Read(stl, MeshFormat::kStl).has_value()) << count;
  }
  EXPECT_LT(GetPeakMemory() - before, int64_t{64} << 20);
}

TEST(SceneFiles, NodesPutTheirMeshesWhereTheirTransformsSay) {
  // A quarter turn about z and a move for the parent, a mirror for the child,
  // which is drawn a second time by a node of its own.
  const FileBytes bytes =
      MakeGlb(MakeTetrahedron(),
              R"([{"rotation": [0, 0, 0.70710678118654752, 0.70710678118654752],
           "translation": [1, 0, 0], "children": [1, 2]},
          {"mesh": 0, "scale": [-1, 1, 1]}, {"mesh": 0}])");
  const auto mesh = Read(bytes, MeshFormat::kGlb);
  ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
  ASSERT_EQ(mesh->num_triangles(), 8);
  // x of the tetrahedron becomes y, mirrored -y; y becomes -x, from x = 1.
  EXPECT_LT((mesh->box_min() - Eigen::Vector3d(0.875, -0.125, 0)).norm(), 1e-6);
  EXPECT_LT((mesh->box_max() - Eigen::Vector3d(1, 0.125, 0.125)).norm(), 1e-6);
  // Both look outwards still.
  EXPECT_NEAR(CalcMassProperties(*mesh).volume,
              2 * CalcMassProperties(MakeTetrahedron()).volume, 1e-9);
}

TEST(SceneFiles, TheirOwnUnitHoldsUnlessAnotherIsStated) {
  const TriangleMesh mesh = MakeTetrahedron();
  for (const auto& [bytes, format, own] :
       {std::tuple(MakeDae(mesh, 0.01), MeshFormat::kDae, 0.01),
        std::tuple(MakeGlb(mesh), MeshFormat::kGlb, 1.0),
        std::tuple(MakeObj(mesh), MeshFormat::kObj, 1.0)}) {
    const auto by_itself = ReadMesh(bytes, format, std::nullopt, MeshLimits{});
    ASSERT_TRUE(by_itself.has_value()) << by_itself.error().message;
    EXPECT_NEAR(by_itself->box_max().x(), 0.125 * own, 1e-8);
    const auto stated = ReadMesh(bytes, format, 0.001, MeshLimits{});
    ASSERT_TRUE(stated.has_value());
    EXPECT_NEAR(stated->box_max().x(), 0.125 * 0.001, 1e-9);
  }
}

TEST(SceneFiles, NoAxisIsTurnedUp) {
  const TriangleMesh box = workshop::MakeBox({0.125, 0.25, 0.5});
  for (const char* up : {"X_UP", "Y_UP", "Z_UP"}) {
    const auto mesh = Read(MakeDae(box, 1.0, up), MeshFormat::kDae);
    ASSERT_TRUE(mesh.has_value());
    EXPECT_LT((mesh->box_max() - box.box_max()).norm(), 1e-6) << up;
  }
}

TEST(SceneFiles, AreTakenOnlyWhole) {
  const TriangleMesh mesh = MakeTetrahedron();
  for (const char* uri :
       {R"("uri": "file:///etc/passwd", )", R"("uri": "http://a.example/b", )",
        R"("uri": "buffer.bin", )"}) {
    const auto outside =
        Read(ToBytes(MakeGltfJson(mesh, uri, kOneNode)), MeshFormat::kGltf);
    ASSERT_FALSE(outside.has_value()) << uri;
    EXPECT_EQ(outside.error().code, ErrorCode::kUnusableInput);
  }
}

TEST(SceneFiles, MayNotHoldMoreThanTheLimitByRepeatingAMesh) {
  std::string nodes = R"([{"children": [)";
  for (int i = 1; i <= 40; ++i)
    nodes += fmt::format("{}{}", i > 1 ? "," : "", i);
  nodes += "]}";
  for (int i = 1; i <= 40; ++i) nodes += R"(,{"mesh": 0})";
  MeshLimits limits;
  limits.max_triangles = 100;
  const auto mesh = ReadMesh(MakeGlb(MakeTetrahedron(), nodes + "]"),
                             MeshFormat::kGlb, 1.0, limits);
  ASSERT_FALSE(mesh.has_value());
  EXPECT_EQ(mesh.error().code, ErrorCode::kTooLarge);
}

TEST(OffFiles, TakePolygonsPrefixesAndComments) {
  const auto mesh = Read(ToBytes("# made by hand\nCOFF\n5 2 0 # counts\n"
                                 "0 0 0 255 0 0 255\n1 0 0 1 1 1 1\n"
                                 "1 1 0 1 1 1 1\n0 1 0 1 1 1 1\n0 0 1 1 1 1 1\n"
                                 "\n4 0 1 2 3 0.5 0.5 0.5\n3 0 1 4\n"),
                         MeshFormat::kOff);
  ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
  EXPECT_EQ(mesh->num_triangles(), 3);
  for (const char* text :
       {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "OFF\n3 1\n0 0 0\n",
        "OFF\n-3 1 0\n", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n",
        "4OFF\n3 1 0\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n", "OFF\nx\n"}) {
    EXPECT_FALSE(Read(ToBytes(text), MeshFormat::kOff).has_value()) << text;
  }
}

TEST(MeshFormat, IsKnownByItsUsualNames) {
  for (const char* name : {"obj", ".OBJ", "model/obj"}) {
    EXPECT_EQ(*ParseMeshFormat(name), MeshFormat::kObj);
  }
  for (const char* name : {"STL", ".stl", "model/stl", "application/sla"}) {
    EXPECT_EQ(*ParseMeshFormat(name), MeshFormat::kStl);
  }
  for (const char* name : {"ply", ".Ply", "model/ply"}) {
    EXPECT_EQ(*ParseMeshFormat(name), MeshFormat::kPly);
  }
  EXPECT_EQ(*ParseMeshFormat("model/gltf-binary"), MeshFormat::kGlb);
  EXPECT_EQ(*ParseMeshFormat("gltf"), MeshFormat::kGltf);
  for (const MeshFormat format : kMeshFormats) {
    EXPECT_EQ(*ParseMeshFormat(GetName(format)), format);
  }
  const auto unknown = ParseMeshFormat("fbx");
  ASSERT_FALSE(unknown.has_value());
  EXPECT_EQ(unknown.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(unknown.error().hint, HasSubstr("obj, stl, ply, off, glb"));
}

TEST(MeshFormat, IsGuessedFromTheNameFirstAndTheContentElse) {
  for (const auto& [name, bytes] : MakeEveryFile(MakeTetrahedron())) {
    const auto by_name = GuessMeshFormat({}, name);
    const auto by_content = GuessMeshFormat(bytes, "");
    ASSERT_TRUE(by_name.has_value() && by_content.has_value()) << name;
    EXPECT_EQ(*by_name, *by_content) << name;
    EXPECT_EQ(*GuessMeshFormat(bytes, "mesh.bin"), *by_content) << name;
  }
  for (const char* text :
       {"", "\n\n", "# nothing else\n", "o", "x 1", "1 2 x"}) {
    const auto guess = GuessMeshFormat(ToBytes(text), "");
    if (std::string(text) == "o") {
      EXPECT_TRUE(guess.has_value());
      continue;
    }
    ASSERT_FALSE(guess.has_value()) << text;
    EXPECT_EQ(guess.error().code, ErrorCode::kUnusableInput);
  }
}

}  // namespace
}  // namespace graspdb
