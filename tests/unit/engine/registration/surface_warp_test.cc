#include "engine/registration/surface_warp.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/geometry/surface_index.h"
#include "engine/geometry/surface_sampling.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// A cylinder whose radius grows with height, which no affine map makes of one.
TriangleMesh MakeTapered(double taper) {
  const TriangleMesh cylinder = workshop::MakeCylinder(0.03, 0.1);
  std::vector<Eigen::Vector3d> vertices = cylinder.vertices();
  for (Eigen::Vector3d& p : vertices) {
    p.head<2>() *= 1.0 + taper * p.z() / 0.05;
  }
  return TriangleMesh(vertices, cylinder.triangles());
}

double CalcMeanDistance(const SurfaceSamples& samples,
                        const SurfaceIndex& index) {
  double sum = 0.0;
  for (const Eigen::Vector3d& p : samples.points) {
    sum += index.FindClosest(p)->distance;
  }
  return sum / samples.size();
}

TEST(SurfaceWarp, BendsACylinderOntoATaperedOne) {
  const TriangleMesh tapered = MakeTapered(0.3);
  const SurfaceIndex index(tapered);
  const SurfaceSamples E =
      SamplePoissonDisk(workshop::MakeCylinder(0.03, 0.1), 800, 1);
  const SurfaceSamples N = SamplePoissonDisk(tapered, 800, 2);
  const SurfaceSamples warped = WarpSamples(E, N, {});
  EXPECT_LT(CalcMeanDistance(warped, index), 0.3 * CalcMeanDistance(E, index));
  // Side normals lean down by the taper, which is 0.3 · 30 mm on 50 mm.
  double lean = 0.0;
  int sides = 0;
  for (int i = 0; i < E.size(); ++i) {
    EXPECT_NEAR(warped.normals[i].norm(), 1.0, 1e-9);
    if (std::abs(E.normals[i].z()) > 0.1 || std::abs(E.points[i].z()) > 0.03) {
      continue;
    }
    lean += warped.normals[i].z();
    ++sides;
  }
  EXPECT_NEAR(lean / sides, -std::sin(std::atan(0.18)), 0.06);
}

TEST(SurfaceWarp, LeavesWhatFitsNearlyWhereItIs) {
  const TriangleMesh box = workshop::MakeBox({0.04, 0.06, 0.1}, 8);
  const SurfaceSamples E = SamplePoissonDisk(box, 800, 1);
  const SurfaceSamples warped =
      WarpSamples(E, SamplePoissonDisk(box, 800, 2), {});
  double moved = 0.0;
  for (int i = 0; i < E.size(); ++i) {
    moved += (warped.points[i] - E.points[i]).norm() / E.size();
  }
  EXPECT_LT(moved, 0.002);
}

TEST(SurfaceWarp, MappedSamplesFollowTheAffineMap) {
  SurfaceSamples samples;
  samples.points = {{0.01, 0.02, 0.03}};
  samples.normals = {{1, 0, 0}};
  AffineMap map;
  map.linear.diagonal() << 2, 1, 1;
  map.translation = {0, 0, 0.1};
  const SurfaceSamples mapped = MapSamples(samples, map);
  EXPECT_LT((mapped.points[0] - Eigen::Vector3d(0.02, 0.02, 0.13)).norm(),
            1e-12);
  EXPECT_LT((mapped.normals[0] - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);
}

}  // namespace
}  // namespace graspdb
