#include "engine/transfer/contact_map.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/geometry/surface_sampling.h"
#include "engine/registration/surface_warp.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// The same box twice, the second one turned and moved.
class BoxOntoItself : public ::testing::Test {
 protected:
  ContactMap MakeMap() const {
    const SurfaceSamples samples_E = SamplePoissonDisk(box_E_, 1000, 1);
    return {samples_E,
            SamplePoissonDisk(box_N_, 1000, 2),
            MapSamples(samples_E, {X_NE_.rotation, X_NE_.translation}),
            index_E_,
            index_N_,
            {}};
  }

  const TriangleMesh box_E_ = workshop::MakeBox({0.04, 0.06, 0.1}, 8);
  const RigidTransform X_NE_{
      Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, 3).normalized())
          .toRotationMatrix(),
      {0.3, -0.2, 0.1}};
  const TriangleMesh box_N_ = CalcTransformed(box_E_, X_NE_);
  const SurfaceIndex index_E_{box_E_};
  const SurfaceIndex index_N_{box_N_};
};

TEST_F(BoxOntoItself, MapIsTheIdentityWhenSamplesCoincide) {
  const SurfaceSamples samples_E = SamplePoissonDisk(box_E_, 400, 1);
  SurfaceSamples samples_N = samples_E;
  for (int i = 0; i < samples_E.size(); ++i) {
    samples_N.points[i] = X_NE_ * samples_E.points[i];
    samples_N.normals[i] = X_NE_.rotation * samples_E.normals[i];
  }
  const ContactMap map(samples_E, samples_N, samples_N, index_E_, index_N_, {});
  for (int i = 0; i < samples_E.size(); ++i) {
    EXPECT_EQ(map.forward()[i], i);
    EXPECT_EQ(map.backward()[i], i);
  }
  // Next to edges a mean of neighbours falls short of the point itself.
  EXPECT_GT(map.CalcMappedShare(), 0.95);
}

TEST_F(BoxOntoItself, ThereAndBackAgainIsNear) {
  const ContactMap map = MakeMap();
  const Eigen::Vector3d p_E(0.02, 0.01, 0.02), nhat_E(1, 0, 0);
  const auto p_N = map.MapForward(p_E, nhat_E);
  ASSERT_TRUE(p_N.has_value());
  const auto back = map.MapBackward(*p_N, X_NE_.rotation * nhat_E);
  ASSERT_TRUE(back.has_value());
  EXPECT_LT((*back - p_E).norm(), 0.008);
  EXPECT_NEAR(map.CalcRoundTripError(p_E, nhat_E).value(), (*back - p_E).norm(),
              1e-12);
}

TEST_F(BoxOntoItself, ImagesLieOnTheSurfaceNearTheTruth) {
  const ContactMap map = MakeMap();
  const Eigen::Vector3d p_E(0.02, 0.01, 0.02), nhat_E(1, 0, 0);
  const auto p_N = map.MapConsistently(p_E, nhat_E);
  ASSERT_TRUE(p_N.has_value());
  EXPECT_LT((*p_N - X_NE_ * p_E).norm(), 0.005);
  EXPECT_LT(index_N_.FindClosest(*p_N)->distance, 1e-9);
}

TEST_F(BoxOntoItself, NoNormalWithinTheGateMeansNoImage) {
  // Turned by 45 degrees about z, side normals are 45 degrees apart from any
  // novel one: more than δ = 30 degrees.
  AffineMap turned;
  turned.linear =
      Eigen::AngleAxisd(M_PI / 4, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const SurfaceSamples samples_E = SamplePoissonDisk(box_E_, 600, 1);
  const ContactMap map(samples_E, SamplePoissonDisk(box_E_, 600, 2),
                       MapSamples(samples_E, turned), index_E_, index_E_, {});
  EXPECT_FALSE(map.MapForward({0.02, 0, 0}, {1, 0, 0}).has_value());
  EXPECT_TRUE(map.MapForward({0, 0, 0.05}, {0, 0, 1}).has_value());
}

}  // namespace
}  // namespace graspdb
