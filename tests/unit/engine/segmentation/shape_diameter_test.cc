#include "engine/segmentation/shape_diameter.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/contract.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

TEST(CalcShapeDiameters, MeasureThePlatesThickness) {
  const double thickness = 0.01;
  const TriangleMesh plate = workshop::MakeBox({1, 1, thickness}, 10);
  const auto diameters = CalcShapeDiameters(plate);
  for (int f = 0; f < plate.num_triangles(); ++f) {
    const bool is_inner = std::abs(plate.normal(f).z()) > 0.5 &&
                          plate.centroid(f).head<2>().norm() < 0.4;
    if (!is_inner) continue;
    // Between straight across and 60 degrees aslant.
    EXPECT_GT(diameters[f], thickness);
    EXPECT_LT(diameters[f], 2.0 * thickness);
  }
}

TEST(CalcShapeDiameters, GrowWithTheMesh) {
  const TriangleMesh small = workshop::MakeCylinder(0.02, 0.1, 24, 4);
  const auto before = CalcShapeDiameters(small);
  const auto after = CalcShapeDiameters(CalcTransformed(small, {}, 10.0));
  for (size_t f = 0; f < before.size(); ++f) {
    EXPECT_NEAR(after[f], 10.0 * before[f], 1e-3 * after[f]);
  }
}

TEST(CalcThicknessCosts, TellThinFromThickByTheLikelierOfTwoClusters) {
  const TriangleMesh mesh = workshop::MakeBox({1, 1, 1}, 5);
  std::vector<double> diameters(mesh.num_triangles());
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    const bool is_thick = f % 3 == 0;
    diameters[f] = (is_thick ? 0.05 : 0.01) * (1.0 + 0.01 * (f % 7));
  }
  const auto costs = CalcThicknessCosts(mesh, diameters, 2);
  ASSERT_EQ(costs.size(), 2u);
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    const int likely = f % 3 == 0 ? 1 : 0;
    EXPECT_NEAR(costs[likely][f], 0.0, 1e-3);
    EXPECT_GT(costs[1 - likely][f], 5.0);
  }
}

TEST(CalcThicknessCosts, DoNotDependOnTheUnit) {
  const TriangleMesh mesh = workshop::LoadMug("latte").mesh_O;
  std::vector<double> diameters = CalcShapeDiameters(mesh);
  const auto before = CalcThicknessCosts(mesh, diameters, 4);
  for (double& diameter : diameters) diameter *= 1024.0;
  const auto after = CalcThicknessCosts(mesh, diameters, 4);
  for (int k = 0; k < 4; ++k) {
    for (int f = 0; f < mesh.num_triangles(); ++f) {
      EXPECT_NEAR(after[k][f], before[k][f], 1e-9);
    }
  }
}

TEST(CalcThicknessCosts, AreZeroForASingleClusterAndForOneThickness) {
  const TriangleMesh mesh = workshop::MakeBox({1, 1, 1}, 2);
  const std::vector<double> same(mesh.num_triangles(), 0.02);
  const auto single = CalcThicknessCosts(mesh, same, 1);
  for (const double cost : single.front()) EXPECT_NEAR(cost, 0.0, 1e-9);
  for (const auto& row : CalcThicknessCosts(mesh, same, 3)) {
    for (const double cost : row) EXPECT_TRUE(std::isfinite(cost));
  }
  EXPECT_THROW(CalcThicknessCosts(mesh, same, 0), ContractViolation);
  EXPECT_THROW(CalcThicknessCosts(mesh, {0.1}, 2), ContractViolation);
}

TEST(SegmentByShapeDiameter, SeparatesAThinHandleFromAThickBody) {
  const LabelledMesh mug = workshop::LoadMug("classic");
  const auto segments =
      SegmentByShapeDiameter(mug.mesh_O, CalcFaceLinks(mug.mesh_O), 0.05, {});
  ASSERT_EQ(segments.size(), mug.face_labels.size());
  // Hardly any segment spans both parts: count each one's minority by area.
  const int count = 1 + *std::max_element(segments.begin(), segments.end());
  std::vector<double> area[2] = {std::vector<double>(count),
                                 std::vector<double>(count)};
  for (int f = 0; f < mug.mesh_O.num_triangles(); ++f) {
    area[mug.face_labels[f]][segments[f]] += mug.mesh_O.area(f);
  }
  double minority = 0.0;
  for (int s = 0; s < count; ++s) minority += std::min(area[0][s], area[1][s]);
  EXPECT_LT(minority, 0.01 * mug.mesh_O.total_area());
  EXPECT_GT(count, 1);
}

}  // namespace
}  // namespace graspdb
