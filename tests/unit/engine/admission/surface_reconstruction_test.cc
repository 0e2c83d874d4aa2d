#include "engine/admission/surface_reconstruction.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/admission/mesh_repair.h"
#include "engine/base/random.h"
#include "engine/geometry/surface_index.h"
#include "engine/geometry/surface_sampling.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

using ::testing::HasSubstr;

using Points = std::vector<Eigen::Vector3d>;

// Evenly spread, each coordinate with normal noise.
Points MakeCloud(const TriangleMesh& mesh, int count, double noise) {
  Points points = SamplePoissonDisk(mesh, count, 3).points;
  Random random(5);
  for (Eigen::Vector3d& p : points) {
    for (double& x : p) x += noise * random.NextNormal();
  }
  return points;
}

double CalcMeanDistance(const TriangleMesh& from, const TriangleMesh& to) {
  const SurfaceIndex index(to);
  double sum = 0.0;
  for (int f = 0; f < from.num_triangles(); ++f) {
    sum += from.area(f) * index.FindClosest(from.centroid(f))->distance;
  }
  return sum / from.total_area();
}

TEST(SurfaceReconstruction, GivesTheSolidBack) {
  const TriangleMesh cylinder = workshop::MakeCylinder(0.03, 0.1, 64, 16);
  for (const double noise : {0.0, 0.0015}) {
    const auto surface = ReconstructSurface(MakeCloud(cylinder, 1500, noise));
    ASSERT_TRUE(surface.has_value()) << surface.error().message;
    EXPECT_TRUE(IsClosed(surface->mesh_O));
    EXPECT_FALSE(surface->report.one_sided);
    EXPECT_NEAR(surface->report.noise, noise, 0.0006);
    EXPECT_LT(CalcMeanDistance(surface->mesh_O, cylinder), 0.0015);
    EXPECT_LT(CalcMeanDistance(cylinder, surface->mesh_O), 0.0015);
    const double volume = CalcMassProperties(cylinder).volume;
    EXPECT_NEAR(CalcMassProperties(surface->mesh_O).volume, volume,
                0.12 * volume);
  }
}

TEST(SurfaceReconstruction, KeepsAMugOpenAndItsHandleAHandle) {
  const TriangleMesh mug = workshop::LoadMug("classic").mesh_O;
  const auto surface = ReconstructSurface(MakeCloud(mug, 4000, 0.0005));
  ASSERT_TRUE(surface.has_value()) << surface.error().message;
  const auto solid = RepairMesh(surface->mesh_O);
  ASSERT_TRUE(solid.has_value()) << solid.error().message;
  const SurfaceIndex index(solid->mesh);
  EXPECT_GT(index.CalcSignedDistance({0.0, 0.0, 0.06}), 0.02);  // The hollow.
  EXPECT_GT(index.CalcSignedDistance({0.056, 0.0, 0.05}), 0.005);  // The eye.
  EXPECT_LT(CalcMeanDistance(solid->mesh, mug), 0.001);
}

TEST(SurfaceReconstruction, KnowsACloudFromOneSideAndClosesIt) {
  const TriangleMesh sphere = workshop::MakeSphere(0.04, 40);
  Points half;
  for (const Eigen::Vector3d& p : MakeCloud(sphere, 3000, 0.0005)) {
    if (p.x() > 0.0) half.push_back(p);
  }
  const auto surface = ReconstructSurface(half);
  ASSERT_TRUE(surface.has_value()) << surface.error().message;
  EXPECT_TRUE(surface->report.one_sided);
  EXPECT_TRUE(IsClosed(surface->mesh_O));
  // Half a ball, no shell of 1 mm.
  const double ball = CalcMassProperties(sphere).volume;
  EXPECT_GT(CalcMassProperties(surface->mesh_O).volume, 0.35 * ball);
}

TEST(SurfaceReconstruction, DropsWhatLiesApart) {
  Points points = MakeCloud(workshop::MakeSphere(0.04, 40), 2000, 0.0);
  Random random(7);
  for (int i = 0; i < 20; ++i) {
    points.push_back(0.2 * Eigen::Vector3d(random.NextUniform(1.0, 2.0),
                                           random.NextUniform(1.0, 2.0),
                                           random.NextUniform(1.0, 2.0)));
  }
  for (int i = 0; i < 30; ++i) {  // A cluster of its own.
    points.emplace_back(0.001 * (i % 6), 0.001 * (i / 6), 0.3);
  }
  const auto surface = ReconstructSurface(points);
  ASSERT_TRUE(surface.has_value()) << surface.error().message;
  EXPECT_EQ(surface->report.num_outliers, 50);
  EXPECT_LT(surface->mesh_O.diagonal(), 0.15);
  EXPECT_THAT(surface->steps.front(), HasSubstr("50 outlying points"));
}

TEST(SurfaceReconstruction, ThinsOutWhatIsDenserThanNeeded) {
  const auto surface =
      ReconstructSurface(MakeCloud(workshop::MakeSphere(0.04, 40), 25000, 0.0));
  ASSERT_TRUE(surface.has_value());
  EXPECT_LE(surface->points_O.size(), 20000u);
  EXPECT_GT(surface->points_O.size(), 8000u);
}

TEST(SurfaceReconstruction, TheSamePointsGiveTheSameSurface) {
  const Points points = MakeCloud(workshop::MakeSphere(0.04, 40), 800, 0.001);
  EXPECT_TRUE(ReconstructSurface(points)->mesh_O ==
              ReconstructSurface(points)->mesh_O);
}

TEST(SurfaceReconstruction, RefusesWhatTellsTooLittle) {
  const Points points = MakeCloud(workshop::MakeSphere(0.04, 40), 150, 0.0);
  const auto few = ReconstructSurface(points);
  ASSERT_FALSE(few.has_value());
  EXPECT_EQ(few.error().code, ErrorCode::kUnusableInput);
  EXPECT_THAT(few.error().message, HasSubstr("at least 200"));
  EXPECT_FALSE(
      ReconstructSurface(Points(500, Eigen::Vector3d(1, 2, 3))).has_value());
  Points plane;
  for (const Eigen::Vector3d& p :
       MakeCloud(workshop::MakeSphere(0.04, 40), 800, 0.0)) {
    plane.emplace_back(p.x(), p.y(), 0.5 * p.x());
  }
  const auto flat = ReconstructSurface(plane);
  ASSERT_FALSE(flat.has_value());
  EXPECT_THAT(flat.error().message, HasSubstr("in one plane"));
}

}  // namespace
}  // namespace graspdb
