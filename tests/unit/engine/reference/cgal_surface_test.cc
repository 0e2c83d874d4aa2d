#include "engine/reference/cgal_surface.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "engine/geometry/surface_index.h"
#include "engine/segmentation/shape_diameter.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

TEST(CgalSurface, IsAsFarFromAPointAsOurIndexSays) {
  const TriangleMesh mug = workshop::LoadMug("latte").mesh_O;
  const CgalSurface cgal(mug);
  const SurfaceIndex index(mug);
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d p = 0.15 * random.NextInUnitBall();
    EXPECT_NEAR(cgal.CalcDistance(p), index.FindClosest(p)->distance, 1e-9);
  }
}

// A long cylinder is as thick as it is wide, for both.
TEST(CgalSurface, FindsACylinderAsThickAsOurShapeDiametersDo) {
  constexpr double kRadius = 0.02;
  const TriangleMesh cylinder = workshop::MakeCylinder(kRadius, 0.3);
  std::vector<double> theirs = CgalSurface(cylinder).CalcShapeDiameters();
  std::vector<double> ours = CalcShapeDiameters(cylinder);
  ASSERT_EQ(theirs.size(), ours.size());
  const auto median = [](std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
  };
  const double of_cgal = median(theirs);
  EXPECT_NEAR(of_cgal, 2.0 * kRadius, 0.3 * kRadius);
  EXPECT_NEAR(median(ours), of_cgal, 0.2 * kRadius);
}

}  // namespace
}  // namespace graspdb
