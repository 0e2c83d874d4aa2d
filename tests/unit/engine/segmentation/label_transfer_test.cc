#include "engine/segmentation/label_transfer.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/contract.h"
#include "engine/geometry/surface_sampling.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// Three samples in one point at height z, normals up.
void AddSamples(double z, int label, SurfaceSamples& samples,
                std::vector<int>& labels) {
  for (int i = 0; i < 3; ++i) {
    samples.points.emplace_back(0, 0, z);
    samples.normals.push_back(Eigen::Vector3d::UnitZ());
    samples.faces.push_back(0);
    labels.push_back(label);
  }
}

// A triangle whose centroid is the origin, facing up.
TriangleMesh MakeTriangle() {
  return TriangleMesh({{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}}, {{0, 1, 2}});
}

TEST(CalcLabelCosts, AreHalfTheSquaredDistanceInSigmasAboveTheLeast) {
  SurfaceSamples samples;
  std::vector<int> labels;
  AddSamples(0.1, 0, samples, labels);
  AddSamples(0.2, 1, samples, labels);
  SegmentationParameters parameters;
  parameters.unary_sigma = 0.1;
  // E is twice as large as N, and N's radius is 0.5: distances 0.1 and 0.2.
  const AffineMap map{0.5 * Eigen::Matrix3d::Identity(),
                      Eigen::Vector3d::Zero()};
  const auto costs =
      CalcLabelCosts(MakeTriangle(), samples, labels, 3, map, 0.5, parameters);
  ASSERT_EQ(costs.size(), 3u);
  EXPECT_NEAR(costs[0][0], 0.0, 1e-12);
  EXPECT_NEAR(costs[1][0], (0.04 - 0.01) / (2 * 0.01), 1e-12);
  EXPECT_EQ(costs[2][0], parameters.unary_cap);  // It has no samples.
}

TEST(CalcLabelCosts, CountANormalThatPointsTheOtherWay) {
  SurfaceSamples samples;
  std::vector<int> labels;
  AddSamples(0.0, 0, samples, labels);
  AddSamples(0.0, 1, samples, labels);
  for (int i = 3; i < 6; ++i) samples.normals[i] *= -1.0;
  SegmentationParameters parameters;
  parameters.unary_sigma = 1.0;
  parameters.normal_weight = 0.5;
  const auto costs =
      CalcLabelCosts(MakeTriangle(), samples, labels, 2, {}, 1.0, parameters);
  EXPECT_NEAR(costs[1][0], 0.5 * (0.5 * 2.0) * (0.5 * 2.0), 1e-12);
}

TEST(CalcLabelConfidence, IsTheAreaMeanOfTheLabelsShare) {
  // Two faces of areas 1 and 3.
  const TriangleMesh mesh({{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, -3, 0}},
                          {{0, 1, 2}, {0, 3, 1}});
  const auto confidence =
      CalcLabelConfidence(mesh, {0, 0}, {{0.0, 0.0}, {0.0, 6.0}});
  const double sure = 1.0 / (1.0 + std::exp(-6.0));
  EXPECT_NEAR(confidence[0], (1.0 * 0.5 + 3.0 * sure) / 4.0, 1e-12);
  EXPECT_EQ(confidence[1], 0.0);
}

TEST(CutByLabelCosts, PutsTheBorderIntoTheValley) {
  // On the mug itself, with costs that know nothing of a broad band about each
  // end of the handle: the valley between body and handle decides.
  const LabelledMesh mug = workshop::LoadMug("classic");
  const auto links = CalcFaceLinks(mug.mesh_O);
  std::vector<std::vector<double>> costs(
      2, std::vector<double>(mug.face_labels.size(), 0.0));
  for (int f = 0; f < mug.mesh_O.num_triangles(); ++f) {
    costs[1 - mug.face_labels[f]][f] = 6.0;
  }
  for (const FaceLink& link : links) {
    const auto [a, b] = std::pair(link.face_a, link.face_b);
    if (mug.face_labels[a] == mug.face_labels[b]) continue;
    for (int f = 0; f < mug.mesh_O.num_triangles(); ++f) {
      if ((mug.mesh_O.centroid(f) - mug.mesh_O.centroid(a)).norm() < 0.008) {
        costs[0][f] = costs[1][f] = 0.0;
      }
    }
  }
  const auto labels = CutByLabelCosts(mug.mesh_O, links, costs, 0.05, {});
  double wrong = 0.0;
  for (int f = 0; f < mug.mesh_O.num_triangles(); ++f) {
    if (labels[f] != mug.face_labels[f]) wrong += mug.mesh_O.area(f);
  }
  EXPECT_LT(wrong, 0.002 * mug.mesh_O.total_area());
}

}  // namespace
}  // namespace graspdb
