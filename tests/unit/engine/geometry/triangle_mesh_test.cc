#include "engine/geometry/triangle_mesh.h"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/contract.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// A tetrahedron with corners at the origin and one metre along each axis.
TriangleMesh MakeTetrahedron() {
  return TriangleMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                      {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
}

TEST(TriangleMesh, NormalsPointOutAndAreasAdd) {
  const TriangleMesh mesh = MakeTetrahedron();
  EXPECT_TRUE(mesh.normal(0).isApprox(-Eigen::Vector3d::UnitZ()));
  EXPECT_TRUE(mesh.normal(3).isApprox(Eigen::Vector3d::Ones().normalized()));
  EXPECT_NEAR(mesh.total_area(), 1.5 + std::sqrt(3.0) / 2, 1e-15);
}

TEST(TriangleMesh, AnIndexOutOfRangeIsAContractViolation) {
  EXPECT_THROW(TriangleMesh({{0, 0, 0}}, {{0, 0, 1}}), ContractViolation);
}

TEST(MassProperties, OfATetrahedronAreTheTextbooks) {
  // V = 1/6, centre at (1/4, 1/4, 1/4); farthest corner: √(9/16 + 2/16).
  const MassProperties mass = CalcMassProperties(MakeTetrahedron());
  EXPECT_NEAR(mass.volume, 1.0 / 6, 1e-15);
  EXPECT_TRUE(mass.p_McCM.isApprox(Eigen::Vector3d::Constant(0.25), 1e-14));
  EXPECT_NEAR(mass.max_radius, std::sqrt(11.0) / 4, 1e-14);
  // Mean of x² less the centre's: 1/10 - 1/16; of xy: 1/20 - 1/16.
  Eigen::Matrix3d gyration = Eigen::Matrix3d::Constant(1.0 / 80);
  gyration.diagonal().setConstant(2 * 3.0 / 80);
  EXPECT_TRUE(mass.gyration.isApprox(gyration, 1e-14));
}

TEST(MassProperties, MoveWithTheMeshAndGrowWithTheCubeOfScale) {
  const RigidTransform X_AM{
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized())
          .toRotationMatrix(),
      {100, -50, 20}};
  const TriangleMesh mesh = MakeTetrahedron();
  const MassProperties before = CalcMassProperties(mesh);
  const MassProperties after =
      CalcMassProperties(CalcTransformed(mesh, X_AM, 2.0));
  EXPECT_NEAR(after.volume, 8 * before.volume, 1e-10);
  EXPECT_NEAR((after.p_McCM - X_AM * (2.0 * before.p_McCM)).norm(), 0, 1e-10);
  EXPECT_TRUE(after.gyration.isApprox(
      4.0 * X_AM.rotation * before.gyration * X_AM.rotation.transpose(), 1e-9));
}

TEST(IsClosed, HoldsForASolidOnly) {
  EXPECT_TRUE(IsClosed(MakeTetrahedron()));
  const TriangleMesh open({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  EXPECT_FALSE(IsClosed(open));
  EXPECT_FALSE(IsClosed(TriangleMesh()));
  // The same face twice, or one face turned over.
  EXPECT_FALSE(IsClosed(CalcUnion({open, open})));
  const TriangleMesh flipped({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                             {{0, 1, 2}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
  EXPECT_FALSE(IsClosed(flipped));
}

TEST(IsClosed, EndsWithOneTriangleLessOrOneTurnedOverOrTwice) {
  const TriangleMesh sphere = workshop::MakeSphere(0.05, 8);
  ASSERT_TRUE(IsClosed(sphere));
  for (int f = 0; f < sphere.num_triangles(); ++f) {
    std::vector<Eigen::Vector3i> triangles = sphere.triangles();
    std::swap(triangles[f][0], triangles[f][1]);
    EXPECT_FALSE(IsClosed(TriangleMesh(sphere.vertices(), triangles))) << f;
    triangles.push_back(sphere.triangles()[f]);
    EXPECT_FALSE(IsClosed(TriangleMesh(sphere.vertices(), triangles))) << f;
    triangles = sphere.triangles();
    triangles.erase(triangles.begin() + f);
    EXPECT_FALSE(IsClosed(TriangleMesh(sphere.vertices(), triangles))) << f;
  }
}

// A hub of 200,000 triangles: no vertex's edges are compared pair by pair.
TEST(IsClosed, IsSoonToldOfAVertexThatAllTrianglesShare) {
  constexpr int kRim = 100000;
  std::vector<Eigen::Vector3d> vertices{{0, 0, 1}, {0, 0, -1}};
  std::vector<Eigen::Vector3i> triangles;
  for (int i = 0; i < kRim; ++i) {
    const double angle = 2.0 * M_PI * i / kRim;
    vertices.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    const int here = 2 + i, next = 2 + (i + 1) % kRim;
    triangles.emplace_back(0, here, next);
    triangles.emplace_back(1, next, here);
  }
  EXPECT_TRUE(IsClosed(TriangleMesh(vertices, triangles)));
}

}  // namespace
}  // namespace graspdb
