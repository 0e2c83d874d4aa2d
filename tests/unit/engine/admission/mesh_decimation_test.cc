#include "engine/admission/mesh_decimation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/contract.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

double CalcVolume(const TriangleMesh& mesh) {
  return CalcMassProperties(mesh).volume;
}

TEST(Decimate, KeepsTheVolumeAndStaysClosed) {
  const TriangleMesh sphere = workshop::MakeSphere(0.05, 48);
  ASSERT_GT(sphere.num_triangles(), 2000);
  for (const int most : {1000, 401, 100}) {
    const auto work = Decimate(sphere, most);
    ASSERT_TRUE(work.has_value());
    EXPECT_LE(work->num_triangles(), most);
    EXPECT_GE(work->num_triangles(), most - 10);
    EXPECT_TRUE(IsClosed(*work));
    EXPECT_NEAR(CalcVolume(*work), CalcVolume(sphere),
                1e-6 * CalcVolume(sphere));
    // The sagitta of a sphere's face of that size, five times over.
    const double edge =
        std::sqrt(4.0 / std::sqrt(3.0) * sphere.total_area() / most);
    for (const Eigen::Vector3d& p : work->vertices()) {
      EXPECT_NEAR(p.norm(), 0.05, 5 * edge * edge / (8 * 0.05));
    }
  }
}

TEST(Decimate, TakesVeryFineMeshesInTwoSteps) {
  const TriangleMesh box = workshop::MakeBox({0.1, 0.08, 0.06}, 100);
  ASSERT_GT(box.num_triangles(), 100'000);
  const auto work = Decimate(box, 5000);
  ASSERT_TRUE(work.has_value());
  EXPECT_LE(work->num_triangles(), 5000);
  EXPECT_TRUE(IsClosed(*work));
  // Only the box's edges may lose, about the square of a fine edge each.
  EXPECT_NEAR(CalcVolume(*work), 0.1 * 0.08 * 0.06, 1e-3 * 0.1 * 0.08 * 0.06);
}

TEST(Decimate, LeavesASmallMeshAlone) {
  const TriangleMesh cube = workshop::MakeBox({0.1, 0.1, 0.1});
  const auto work = Decimate(cube, 12);
  ASSERT_TRUE(work.has_value());
  EXPECT_TRUE(*work == cube);
  EXPECT_THROW((void)Decimate(cube, 3), ContractViolation);
}

TEST(Decimate, StopsWhereTheTopologyDoes) {
  const auto work = Decimate(workshop::MakeBox({0.1, 0.1, 0.1}), 4);
  ASSERT_TRUE(work.has_value());
  EXPECT_TRUE(IsClosed(*work));
}

}  // namespace
}  // namespace graspdb
