#include "engine/registration/shape_descriptor.h"

#include <numeric>

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "engine/geometry/surface_sampling.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

ShapeDescriptor Describe(const TriangleMesh& mesh, uint64_t seed = 1) {
  return CalcShapeDescriptor(SampleSurface(mesh, 1500, seed));
}

TEST(ShapeDescriptor, SumsToOne) {
  const ShapeDescriptor d = Describe(workshop::MakeSphere(0.04));
  EXPECT_NEAR(std::accumulate(d.begin(), d.end(), 0.0), 1.0, 1e-9);
}

TEST(ShapeDescriptor, OfASphereRisesLinearlyToItsDiameter) {
  // Of a sphere's pairs the share nearer than d is d² / 4r², their mean 4r / 3:
  // in mean distances m it is 4 m² / 9, and 1 from m = 1.5 on.
  const ShapeDescriptor d = Describe(workshop::MakeSphere(0.04, 64));
  double below = 0.0;
  for (size_t i = 0; i < d.size(); ++i) {
    below += d[i];
    const double m = 3.0 * static_cast<double>(i + 1) / 48.0;
    EXPECT_NEAR(below, std::min(1.0, 4.0 * m * m / 9.0), 0.03) << m;
  }
}

TEST(ShapeDescriptor, DoesNotDependOnPoseUnitSamplesOrTriangles) {
  const TriangleMesh mug = workshop::LoadMug("classic").mesh_O;
  const ShapeDescriptor known = Describe(mug);
  Random random(4);
  std::vector<Eigen::Vector3d> vertices;
  const Eigen::Matrix3d R = random.NextRotation();
  for (const Eigen::Vector3d& p : mug.vertices()) {
    vertices.push_back(1000.0 * (R * p + Eigen::Vector3d(1, 2, 3)));
  }
  const TriangleMesh moved(vertices, mug.triangles());
  EXPECT_LT(CalcDescriptorDistance(known, Describe(moved)), 1e-6);
  EXPECT_LT(CalcDescriptorDistance(known, Describe(mug, 2)), 0.2);
  EXPECT_LT(CalcDescriptorDistance(Describe(workshop::MakeBox({1, 2, 3}, 1)),
                                   Describe(workshop::MakeBox({1, 2, 3}, 9))),
            0.2);
}

TEST(ShapeDescriptor, TellsMugsFromHammers) {
  const auto describe = [](const char* category, const char* name) {
    return Describe(workshop::LoadObject(category, name).mesh_O);
  };
  const ShapeDescriptor mug = describe("mug", "classic");
  EXPECT_LT(CalcDescriptorDistance(mug, describe("mug", "latte")),
            0.5 * CalcDescriptorDistance(mug, describe("hammer", "claw")));
}

TEST(DescriptorDistance, IsTheWorkOfMovingTheOneIntoTheOther) {
  ShapeDescriptor a{}, b{};
  a[3] = 1.0;
  b[3] = 0.5;
  b[7] = 0.5;
  EXPECT_DOUBLE_EQ(CalcDescriptorDistance(a, b), 2.0);  // Half, four bins far.
  EXPECT_DOUBLE_EQ(CalcDescriptorDistance(b, a), 2.0);
  EXPECT_DOUBLE_EQ(CalcDescriptorDistance(a, a), 0.0);
}

}  // namespace
}  // namespace graspdb
