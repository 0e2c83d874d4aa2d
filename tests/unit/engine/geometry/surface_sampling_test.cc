#include "engine/geometry/surface_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// An axis-aligned box from the origin; faces 2k and 2k + 1 form side k:
// z = 0, z = top, y = 0, y = top, x = 0, x = top.
TriangleMesh MakeBox(const Eigen::Vector3d& size) {
  std::vector<Eigen::Vector3d> p;
  for (int i = 0; i < 8; ++i) {
    p.push_back(size.cwiseProduct(Eigen::Vector3d(i & 1, i >> 1 & 1, i >> 2)));
  }
  return TriangleMesh(p, {{0, 2, 3},
                          {0, 3, 1},
                          {4, 5, 7},
                          {4, 7, 6},
                          {0, 1, 5},
                          {0, 5, 4},
                          {2, 6, 7},
                          {2, 7, 3},
                          {0, 4, 6},
                          {0, 6, 2},
                          {1, 3, 7},
                          {1, 7, 5}});
}

double FindSmallestSpacing(const SurfaceSamples& samples) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < samples.size(); ++i) {
    for (int j = 0; j < i; ++j) {
      if (samples.normals[i].dot(samples.normals[j]) < 0.0) continue;
      smallest =
          std::min(smallest, (samples.points[i] - samples.points[j]).norm());
    }
  }
  return smallest;
}

void ExpectOnTheirFaces(const TriangleMesh& mesh,
                        const SurfaceSamples& samples) {
  ASSERT_EQ(samples.points.size(), samples.faces.size());
  ASSERT_EQ(samples.points.size(), samples.normals.size());
  for (int i = 0; i < samples.size(); ++i) {
    const int f = samples.faces[i];
    EXPECT_EQ(samples.normals[i], mesh.normal(f));
    EXPECT_NEAR(mesh.normal(f).dot(samples.points[i] - mesh.corner(f, 0)), 0,
                1e-12);
    for (int k = 0; k < 3; ++k) {  // Inside of each edge.
      const Eigen::Vector3d edge =
          mesh.corner(f, (k + 1) % 3) - mesh.corner(f, k);
      EXPECT_GE(
          edge.cross(samples.points[i] - mesh.corner(f, k)).dot(mesh.normal(f)),
          -1e-12);
    }
  }
}

TEST(SampleSurface, GivesEachFaceItsShareOfTheArea) {
  const TriangleMesh box = MakeBox({1, 2, 3});
  const SurfaceSamples samples = SampleSurface(box, 2200, 3);
  ExpectOnTheirFaces(box, samples);
  std::array<int, 12> count{};
  for (const int face : samples.faces) ++count[face];
  // 100 per square metre: each face within one stratum at either end.
  for (int f = 0; f < 12; ++f) EXPECT_NEAR(count[f], 100 * box.area(f), 1.01);
}

TEST(SampleSurface, IsUniformWithinAFace) {
  // The mean of points uniform in a triangle is its centroid; the standard
  // deviation of a coordinate is side / sqrt(18).
  const TriangleMesh triangle({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const SurfaceSamples samples = SampleSurface(triangle, 20000, 1);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : samples.points) mean += p / samples.size();
  const double sigma = 1.0 / std::sqrt(18.0 * samples.size());
  EXPECT_NEAR(mean.x(), 1.0 / 3.0, 4.0 * sigma);
  EXPECT_NEAR(mean.y(), 1.0 / 3.0, 4.0 * sigma);
}

TEST(SampleSurface, MovesAndScalesWithTheMesh) {
  const TriangleMesh box = MakeBox({1, 2, 3});
  const RigidTransform X{
      Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX()).toRotationMatrix(),
      {4, 5, 6}};
  const SurfaceSamples before = SampleSurface(box, 100, 7);
  const SurfaceSamples after =
      SampleSurface(CalcTransformed(box, X, 10), 100, 7);
  for (int i = 0; i < 100; ++i) {
    EXPECT_NEAR((after.points[i] - X * (10.0 * before.points[i])).norm(), 0,
                1e-10);
  }
}

TEST(SampleSurface, SkipsFacesWithoutAreaAndRefusesAMeshWithoutAny) {
  const TriangleMesh mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                          {{0, 0, 1}, {0, 1, 2}, {1, 1, 1}});
  for (const int face : SampleSurface(mesh, 50, 1).faces) EXPECT_EQ(face, 1);
  EXPECT_THROW(SampleSurface(mesh, 50, 1, 1), ContractViolation);
  EXPECT_THROW(SampleSurface(mesh, 0, 1), ContractViolation);
  EXPECT_THROW(SampleSurface(TriangleMesh(), 5, 1), ContractViolation);
}

TEST(SamplePoissonDisk, GivesExactlySoManyPointsOnTheSurface) {
  const TriangleMesh box = MakeBox({1, 2, 3});
  const SurfaceSamples samples = SamplePoissonDisk(box, 300, 5);
  EXPECT_EQ(samples.size(), 300);
  ExpectOnTheirFaces(box, samples);
}

TEST(SamplePoissonDisk, KeepsPointsMuchFartherApartThanChance) {
  const TriangleMesh box = MakeBox({1, 2, 3});
  // The densest packing of 400 discs on 22 square metres has a spacing of
  // sqrt(2 A / sqrt(3) N) = 0.252 m; blue noise reaches about 0.7 of it.
  const double densest = std::sqrt(2 * 22.0 / (std::sqrt(3.0) * 400));
  EXPECT_GT(FindSmallestSpacing(SamplePoissonDisk(box, 400, 1)),
            0.55 * densest);
  EXPECT_LT(FindSmallestSpacing(SampleSurface(box, 400, 1)), 0.2 * densest);
}

TEST(SamplePoissonDisk, CoversBothSidesOfAThinWall) {
  const TriangleMesh plate = MakeBox({1, 1, 1e-4});
  int above = 0;
  for (const Eigen::Vector3d& normal :
       SamplePoissonDisk(plate, 200, 1).normals) {
    if (normal.z() > 0.5) ++above;
  }
  EXPECT_NEAR(above, 100, 10);
}

TEST(SamplePoissonDisk, LeavesTheCapsOut) {
  const TriangleMesh box = MakeBox({1, 1, 1});
  for (const int face : SamplePoissonDisk(box, 100, 1, 4).faces) {
    EXPECT_LT(face, 4);
  }
}

TEST(SurfaceSampling, GivesTheSameForTheSameSeedOnly) {
  const TriangleMesh box = MakeBox({1, 2, 3});
  EXPECT_EQ(SamplePoissonDisk(box, 100, 9), SamplePoissonDisk(box, 100, 9));
  EXPECT_NE(SamplePoissonDisk(box, 100, 9), SamplePoissonDisk(box, 100, 8));
  EXPECT_NE(SampleSurface(box, 100, 9), SampleSurface(box, 100, 8));
}

}  // namespace
}  // namespace graspdb
