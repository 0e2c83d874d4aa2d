#include "engine/admission/mesh_repair.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/admission/mesh_decimation.h"
#include "engine/base/random.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Triangles = std::vector<Eigen::Vector3i>;
using Vertices = std::vector<Eigen::Vector3d>;

constexpr double kSide = 0.1;
constexpr double kCube = kSide * kSide * kSide;

// Two triangles a side.
TriangleMesh MakeCube() { return workshop::MakeBox({kSide, kSide, kSide}); }

TriangleMesh Move(const TriangleMesh& mesh, const Eigen::Vector3d& by) {
  return CalcTransformed(mesh, RigidTransform{Eigen::Matrix3d::Identity(), by});
}

TriangleMesh Turn(const TriangleMesh& mesh) {
  Triangles triangles = mesh.triangles();
  for (Eigen::Vector3i& t : triangles) std::swap(t[1], t[2]);
  return TriangleMesh(mesh.vertices(), triangles);
}

// Leaves out the faces whose centroid satisfies the condition.
template <typename Condition>
TriangleMesh Without(const TriangleMesh& mesh, const Condition& condition) {
  Triangles triangles;
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    if (!condition(mesh.centroid(f))) triangles.push_back(mesh.triangles()[f]);
  }
  return TriangleMesh(mesh.vertices(), triangles);
}

double CalcVolume(const TriangleMesh& mesh) {
  return CalcMassProperties(mesh).volume;
}

// The repaired mesh, which must be a solid of that volume, within a share of
// it.
RepairedMesh ExpectSolid(const TriangleMesh& soup, double volume,
                         double share = 1e-9) {
  const auto repaired = RepairMesh(soup);
  if (!repaired) {
    ADD_FAILURE() << repaired.error().message;
    return {};
  }
  EXPECT_TRUE(IsClosed(repaired->mesh));
  EXPECT_NEAR(CalcVolume(repaired->mesh), volume, share * volume);
  // What is repaired needs no repair.
  const auto again = RepairMesh(repaired->mesh);
  EXPECT_TRUE(again.has_value() && again->repairs.empty());
  return *repaired;
}

void ExpectRefused(const TriangleMesh& soup, const char* words) {
  const auto repaired = RepairMesh(soup);
  ASSERT_FALSE(repaired.has_value()) << words;
  EXPECT_EQ(repaired.error().code, ErrorCode::kUnusableInput);
  EXPECT_THAT(repaired.error().message, HasSubstr(words));
  EXPECT_FALSE(repaired.error().hint.empty());
}

TEST(RepairMesh, LeavesASolidExactlyAsItIs) {
  for (const TriangleMesh& mesh : {MakeCube(), workshop::MakeSphere(0.05),
                                   workshop::MakeCylinder(0.04, 0.1)}) {
    const auto repaired = RepairMesh(mesh);
    ASSERT_TRUE(repaired.has_value());
    EXPECT_THAT(repaired->repairs, IsEmpty());
    EXPECT_TRUE(repaired->mesh == mesh);
  }
}

TEST(RepairMesh, LeavesEveryBundledMugAlone) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::string(GRASPDB_SOURCE_DIR) + "/data/mug")) {
    if (entry.path().extension() != ".obj") continue;
    ++count;
    const TriangleMesh mug = workshop::LoadObj(entry.path().string());
    const auto repaired = RepairMesh(mug);
    ASSERT_TRUE(repaired.has_value()) << entry.path();
    EXPECT_THAT(repaired->repairs, IsEmpty()) << entry.path();
    EXPECT_TRUE(repaired->mesh == mug) << entry.path();
  }
  EXPECT_GE(count, 4);
}

TEST(RepairMesh, FillsAnOpenBox) {
  const RepairedMesh repaired = ExpectSolid(
      Without(MakeCube(),
              [](const Eigen::Vector3d& p) { return p.z() > 0.499 * kSide; }),
      kCube);
  EXPECT_THAT(repaired.repairs, ElementsAre("filled 1 hole with 2 faces"));
}

TEST(RepairMesh, FillsLongHolesToo) {
  const TriangleMesh whole = workshop::MakeCylinder(0.04, 0.1, 600, 1);
  const RepairedMesh repaired = ExpectSolid(
      Without(whole, [](const Eigen::Vector3d& p) { return p.z() > 0.0499; }),
      CalcVolume(whole), 1e-6);
  EXPECT_THAT(repaired.repairs, Contains("filled 1 hole with 600 faces"));
}

TEST(RepairMesh, KeepsTheFacesThatNeedNothingInOrder) {
  const TriangleMesh cube = MakeCube();
  const RepairedMesh repaired = ExpectSolid(
      TriangleMesh(cube.vertices(),
                   {cube.triangles().begin(), cube.triangles().end() - 1}),
      kCube);
  ASSERT_EQ(repaired.mesh.num_triangles(), 12);
  for (int f = 0; f < 11; ++f) {
    EXPECT_NEAR((repaired.mesh.centroid(f) - cube.centroid(f)).norm(), 0,
                1e-12);
  }
}

TEST(RepairMesh, TurnsAMeshThatIsInsideOut) {
  const RepairedMesh repaired = ExpectSolid(Turn(MakeCube()), kCube);
  EXPECT_THAT(repaired.repairs,
              ElementsAre("turned 1 shell that was inside out"));
}

TEST(RepairMesh, TurnsFacesThatDisagree) {
  const TriangleMesh cube = MakeCube();
  Triangles triangles = cube.triangles();
  for (const int f : {3, 8}) std::swap(triangles[f][0], triangles[f][1]);
  const RepairedMesh repaired =
      ExpectSolid(TriangleMesh(cube.vertices(), triangles), kCube);
  EXPECT_THAT(repaired.repairs,
              ElementsAre("turned 2 faces to agree with their neighbours"));
}

TEST(RepairMesh, DropsDuplicateAndDegenerateFacesAndUnusedVertices) {
  const TriangleMesh cube = MakeCube();
  Triangles triangles = cube.triangles();
  Vertices vertices = cube.vertices();
  triangles.push_back({triangles[0][1], triangles[0][2], triangles[0][0]});
  triangles.push_back({triangles[5][1], triangles[5][0], triangles[5][2]});
  triangles.push_back({3, 3, 4});
  vertices.push_back({7, 7, 7});
  const auto repaired = RepairMesh(TriangleMesh(vertices, triangles));
  ASSERT_TRUE(repaired.has_value());
  EXPECT_THAT(repaired->repairs, ElementsAre("dropped 1 unused vertex",
                                             "dropped 1 degenerate face",
                                             "dropped 2 duplicate faces"));
  EXPECT_TRUE(repaired->mesh == cube);
}

TEST(RepairMesh, WeldsCornersThatNearlyMeet) {
  const TriangleMesh cube = workshop::MakeBox({kSide, kSide, kSide}, 3);
  Random random(5);
  Vertices vertices;
  Triangles triangles;
  for (int f = 0; f < cube.num_triangles(); ++f) {
    const int first = static_cast<int>(vertices.size());
    for (int k = 0; k < 3; ++k) {
      vertices.push_back(cube.corner(f, k) + 1e-7 * random.NextInUnitBall());
    }
    triangles.emplace_back(first, first + 1, first + 2);
  }
  const RepairedMesh repaired =
      ExpectSolid(TriangleMesh(vertices, triangles), kCube, 1e-4);
  EXPECT_EQ(repaired.mesh.num_triangles(), cube.num_triangles());
  EXPECT_EQ(repaired.mesh.num_vertices(), cube.num_vertices());
  EXPECT_THAT(
      repaired.repairs,
      ElementsAre(fmt::format("welded {} vertices",
                              3 * cube.num_triangles() - cube.num_vertices())));
}

TEST(RepairMesh, DoesNotWeldInsideAClosedSurface) {
  // Two cubes that share an edge's position but no vertex: manifold each.
  const TriangleMesh two = CalcUnion(
      {MakeCube(), Move(MakeCube(), {kSide, 0.7 * kSide, 0.4 * kSide})});
  const auto repaired = RepairMesh(two);
  ASSERT_TRUE(repaired.has_value()) << repaired.error().message;
  for (const std::string& step : repaired->repairs) {
    EXPECT_THAT(step, ::testing::Not(HasSubstr("weld")));
  }
}

TEST(RepairMesh, SplitsEdgesAtTJunctions) {
  // The lid is finer than the walls around it.
  const auto is_lid = [](const Eigen::Vector3d& p) {
    return p.z() > 0.499 * kSide;
  };
  const TriangleMesh walls = Without(MakeCube(), is_lid);
  const TriangleMesh lid =
      Without(workshop::MakeBox({kSide, kSide, kSide}, 4),
              [&is_lid](const Eigen::Vector3d& p) { return !is_lid(p); });
  const RepairedMesh repaired = ExpectSolid(CalcUnion({walls, lid}), kCube);
  EXPECT_THAT(repaired.repairs, Contains("split 4 edges at T-junctions"));
  // Three vertices inside each of four edges: twelve faces more.
  EXPECT_EQ(repaired.mesh.num_triangles(), 10 + 32 + 12);
}

TEST(RepairMesh, UnitesShellsThatOverlap) {
  // The second cube is moved by half a side along x and a fifth along y and z.
  const RepairedMesh repaired =
      ExpectSolid(CalcUnion({MakeCube(), Move(MakeCube(), {0.05, 0.02, 0.02})}),
                  kCube * (2.0 - 0.5 * 0.8 * 0.8));
  EXPECT_THAT(repaired.repairs, ElementsAre("united 2 shells"));
}

TEST(RepairMesh, UnitesOpenAndInvertedShells) {
  const TriangleMesh open =
      Without(Move(MakeCube(), {0.05, 0.02, 0.02}),
              [](const Eigen::Vector3d& p) { return p.x() < 0.0 + 1e-6; });
  const RepairedMesh repaired = ExpectSolid(CalcUnion({Turn(MakeCube()), open}),
                                            kCube * (2.0 - 0.5 * 0.8 * 0.8));
  EXPECT_THAT(
      repaired.repairs,
      ElementsAre("filled 1 hole with 2 faces",
                  "turned 1 shell that was inside out", "united 2 shells"));
}

TEST(RepairMesh, SwallowsAShellInsideAnother) {
  const TriangleMesh inner = workshop::MakeBox({0.02, 0.03, 0.04});
  ExpectSolid(CalcUnion({MakeCube(), inner}), kCube);
  ExpectSolid(CalcUnion({MakeCube(), Turn(inner)}), kCube);
}

TEST(RepairMesh, CutsOutWhatCrossesItself) {
  const TriangleMesh sphere = workshop::MakeSphere(0.05);
  Vertices vertices = sphere.vertices();
  vertices[100] = -1.02 * vertices[100];  // A spike through the other side.
  const RepairedMesh repaired = ExpectSolid(
      TriangleMesh(vertices, sphere.triangles()), CalcVolume(sphere), 0.01);
  EXPECT_THAT(repaired.repairs,
              ElementsAre(AllOf(HasSubstr("cut out and filled"),
                                HasSubstr("crossed others"))));
}

TEST(RepairMesh, DropsSmallFragments) {
  const TriangleMesh crumb =
      Move(workshop::MakeBox({0.004, 0.004, 0.004}), {0.08, 0, 0});
  const RepairedMesh repaired =
      ExpectSolid(CalcUnion({MakeCube(), crumb}), kCube);
  EXPECT_THAT(
      repaired.repairs,
      ElementsAre("united 2 shells", HasSubstr("dropped 1 loose fragment")));
}

TEST(RepairMesh, WrapsSolidsThatNearlyTouch) {
  // The gap is a fifth of a per mille of the diagonal.
  const TriangleMesh two =
      CalcUnion({MakeCube(), Move(MakeCube(), {kSide + 5e-5, 0, 0})});
  const RepairedMesh repaired = ExpectSolid(two, 2 * kCube, 0.03);
  EXPECT_THAT(repaired.repairs,
              Contains(HasSubstr("wrapped 24 faces, closing gaps of up to")));
  // The wrap lies within a thousandth of the diagonal.
  EXPECT_LT((repaired.mesh.box_min() - two.box_min()).norm(),
            two.diagonal() / 1000.0);
  EXPECT_LT((repaired.mesh.box_max() - two.box_max()).norm(),
            two.diagonal() / 1000.0);
}

// Spikes that cross each other took the decoder's whole 20 s.
TEST(RepairMesh, WrapsThreeTimesAsCoarselyWhatWouldTakeTooManyPoints) {
  const TriangleMesh two =
      CalcUnion({MakeCube(), Move(MakeCube(), {kSide + 5e-5, 0, 0})});
  const auto read_gap = [](const RepairedMesh& repaired) {
    const std::string& wrapped = repaired.repairs.back();
    return std::stod(wrapped.substr(wrapped.find("up to ") + 6));
  };
  const double fine = read_gap(ExpectSolid(two, 2 * kCube, 0.03));
  const auto coarse = RepairMesh(two, 3000);
  ASSERT_TRUE(coarse.has_value());
  EXPECT_TRUE(IsClosed(coarse->mesh));
  EXPECT_NEAR(read_gap(*coarse) / fine, 3.0, 0.1);
  EXPECT_NEAR(CalcMassProperties(coarse->mesh).volume, 2 * kCube,
              0.1 * 2 * kCube);
}

TEST(RepairMesh, WrapsRatherThanDropsWhatSticksOut) {
  // A thin rod with a gap of half a per mille of the diagonal: hardly volume.
  const TriangleMesh rod = Move(workshop::MakeBox({0.05, 0.003, 0.003}),
                                {0.5 * kSide + 0.025 + 1e-4, 0, 0});
  const RepairedMesh repaired =
      ExpectSolid(CalcUnion({MakeCube(), rod}), kCube + 0.05 * 9e-6, 0.02);
  EXPECT_NEAR(repaired.mesh.box_max().x(), 0.5 * kSide + 0.05, 5e-4);
}

TEST(RepairMesh, WrapsAnOpenSheet) {
  // Half a tube without ends: its caps would be larger than itself.
  const TriangleMesh sheet = Without(
      workshop::MakeCylinder(0.04, 0.1, 32, 4), [](const Eigen::Vector3d& p) {
        return p.x() < 0.02 || std::abs(p.z()) > 0.0499;
      });
  const auto repaired = RepairMesh(sheet);
  ASSERT_TRUE(repaired.has_value()) << repaired.error().message;
  EXPECT_TRUE(IsClosed(repaired->mesh));
  // A plate less than a two-hundredth of the diagonal thick.
  const double volume = CalcVolume(repaired->mesh);
  EXPECT_GT(volume, 0.0);
  EXPECT_LT(volume, sheet.diagonal() / 200.0 * sheet.total_area());
}

TEST(RepairMesh, GivesTheSameTwice) {
  const TriangleMesh two =
      CalcUnion({MakeCube(), Move(MakeCube(), {kSide + 5e-5, 0, 0}),
                 Move(workshop::MakeSphere(0.03), {0, 0, 0.05})});
  const auto first = RepairMesh(two);
  const TriangleMesh other = workshop::MakeSphere(0.02);  // Stirs the heap.
  const auto second = RepairMesh(two);
  ASSERT_TRUE(first.has_value() && second.has_value());
  EXPECT_TRUE(first->mesh == second->mesh);
  EXPECT_EQ(first->repairs, second->repairs);
}

TEST(RepairMesh, RefusesSolidsApartFromEachOther) {
  ExpectRefused(CalcUnion({MakeCube(), Move(MakeCube(), {0.15, 0, 0})}),
                "2 solids apart");
}

TEST(RepairMesh, RefusesWhatHasNoVolume) {
  ExpectRefused(TriangleMesh(), "no faces");
  ExpectRefused(
      TriangleMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {1, 1, 2}}),
      "no area");
  ExpectRefused(TriangleMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                             {{0, 1, 2}, {1, 3, 2}}),
                "one plane");
  // Tilted: no axis is flat.
  ExpectRefused(
      CalcTransformed(TriangleMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                   {{0, 1, 2}, {1, 3, 2}}),
                      RigidTransform{Random(3).NextRotation(), {1, 2, 3}}),
      "one plane");
  ExpectRefused(workshop::MakeBox({0.1, 0.1, 1e-6}), "one plane");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ExpectRefused(TriangleMesh({{0, 0, 0}, {1, 0, nan}, {0, 1, 0}}, {{0, 1, 2}}),
                "not finite");
}

TEST(RepairMesh, MakesASolidOfEveryExtraObject) {
  const char* folder = std::getenv("GRASPDB_EXTRA_OBJECTS");
  if (folder == nullptr)
    GTEST_SKIP() << "other people's meshes are not in the repository: "
                    "GRASPDB_EXTRA_OBJECTS names a folder";
  int tried = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".obj") continue;
    SCOPED_TRACE(entry.path().string());
    ++tried;
    const TriangleMesh soup = workshop::LoadObj(entry.path().string());
    const auto repaired = RepairMesh(soup);
    ASSERT_TRUE(repaired.has_value()) << repaired.error().message;
    EXPECT_TRUE(IsClosed(repaired->mesh));
    // What the faces enclose without any repair, roughly: shells that overlap
    // count twice, open ones not quite, and wrapping closes gaps.
    const double volume = CalcVolume(repaired->mesh);
    const double rough = std::abs(CalcVolume(soup));
    const bool wrapped = !repaired->repairs.empty() &&
                         repaired->repairs.back().starts_with("wrapped");
    EXPECT_NEAR(volume, rough,
                (IsClosed(soup) && !wrapped ? 0.1 : 0.25) * rough);
    // The box stays within a hundredth of the diagonal.
    const double margin = 0.01 * soup.diagonal();
    EXPECT_LT((repaired->mesh.box_min() - soup.box_min()).norm(), margin);
    EXPECT_LT((repaired->mesh.box_max() - soup.box_max()).norm(), margin);
    const auto work = Decimate(repaired->mesh, 3000);
    ASSERT_TRUE(work.has_value());
    EXPECT_TRUE(IsClosed(*work));
    EXPECT_NEAR(CalcVolume(*work), volume, 0.02 * volume);
  }
  EXPECT_GT(tried, 0) << folder << " has no mesh";
}

}  // namespace
}  // namespace graspdb
