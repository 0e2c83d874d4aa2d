#include "server/bench/scanned_cloud.h"

#include <gtest/gtest.h>

#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// A cube of 20 mm; its upper half is of another label.
class ScannedCube : public ::testing::Test {
 protected:
  ScannedCube() {
    for (int f = 0; f < cube_.num_triangles(); ++f) {
      labels_.push_back(cube_.centroid(f).z() > 0.0 ? 1 : 0);
    }
    options_.points_by_label = {300, 100};
    options_.noise = 0.0;
  }

  const TriangleMesh cube_ = workshop::MakeBox({0.02, 0.02, 0.02}, 2);
  std::vector<int> labels_;
  ScanOptions options_;
};

TEST_F(ScannedCube, HasTheWantedPointsOfEachLabelOnItsSurface) {
  const auto points = ScanSurface(cube_, labels_, options_);
  ASSERT_EQ(points.size(), 400u);
  for (size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(points[i].cwiseAbs().maxCoeff(), 0.01, 1e-12);
    EXPECT_EQ(points[i].z() > 0.0, i >= 300);
  }
}

TEST_F(ScannedCube, IsSeenFromTheCamerasSideOnly) {
  options_.camera_O = Eigen::Vector3d::UnitX();
  for (const Eigen::Vector3d& p : ScanSurface(cube_, labels_, options_)) {
    EXPECT_NEAR(p.x(), 0.01, 1e-12);
  }
}

// Two cubes in a row: the nearer one hides the other one's near side.
TEST_F(ScannedCube, WhatStandsInFrontHidesIt) {
  std::vector<Eigen::Vector3d> vertices = cube_.vertices();
  std::vector<Eigen::Vector3i> triangles = cube_.triangles();
  const int count = cube_.num_vertices();
  for (const Eigen::Vector3d& p : cube_.vertices()) {
    vertices.push_back(p + Eigen::Vector3d(0.05, 0, 0));
  }
  for (Eigen::Vector3i t : cube_.triangles()) {
    for (int& corner : t) corner += count;
    triangles.push_back(t);
  }
  const TriangleMesh both(vertices, triangles);
  options_.points_by_label = {50, 50};
  options_.camera_O = Eigen::Vector3d::UnitX();
  std::vector<int> labels(static_cast<size_t>(both.num_triangles()), 0);
  std::fill(labels.begin() + cube_.num_triangles(), labels.end(), 1);
  const auto points = ScanSurface(both, labels, options_);
  ASSERT_EQ(points.size(), 50u);
  for (const Eigen::Vector3d& p : points) EXPECT_GT(p.x(), 0.03);
}

TEST_F(ScannedCube, NoiseHasTheGivenDeviationAndIsTheSameEachTime) {
  options_.noise = 0.001;
  options_.points_by_label = {2000, 2000};
  const auto points = ScanSurface(cube_, labels_, options_);
  EXPECT_EQ(points, ScanSurface(cube_, labels_, options_));
  // Across the side x = 10 mm, away from its edges.
  double sum = 0.0;
  int count = 0;
  for (const Eigen::Vector3d& p : points) {
    if (p.x() < 0.006 || std::abs(p.y()) > 0.006 || std::abs(p.z()) > 0.006) {
      continue;
    }
    sum += (p.x() - 0.01) * (p.x() - 0.01);
    ++count;
  }
  ASSERT_GT(count, 150);
  EXPECT_NEAR(std::sqrt(sum / count), 0.001, 0.0002);
}

}  // namespace
}  // namespace graspdb
