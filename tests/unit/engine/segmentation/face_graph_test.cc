#include "engine/segmentation/face_graph.h"

#include <algorithm>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// A strip of `count` unit squares along x, two triangles each.
TriangleMesh MakeStrip(int count) {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  for (int i = 0; i <= count; ++i) {
    vertices.emplace_back(i, 0, 0);
    vertices.emplace_back(i, 1, 0);
  }
  for (int i = 0; i < 2 * count; i += 2) {
    triangles.emplace_back(i, i + 2, i + 3);
    triangles.emplace_back(i, i + 3, i + 1);
  }
  return TriangleMesh(vertices, triangles);
}

TEST(CalcFaceLinks, FindsABoxesEdgesWithTheirBends) {
  const auto links = CalcFaceLinks(workshop::MakeBox({1, 2, 3}));
  ASSERT_EQ(links.size(), 18u);  // 12 edges and 6 diagonals.
  int flat = 0;
  double ridge_length = 0.0;
  for (const FaceLink& link : links) {
    if (std::abs(link.angle) < 1e-12) {
      ++flat;
    } else {
      EXPECT_NEAR(link.angle, std::numbers::pi / 2, 1e-12);
      ridge_length += link.length;
    }
  }
  EXPECT_EQ(flat, 6);
  EXPECT_NEAR(ridge_length, 4 * (1 + 2 + 3), 1e-12);
}

TEST(CalcFaceLinks, GivesAValleyANegativeAngle) {
  // Floor and wall meet at right angles; the free space is above the floor.
  const TriangleMesh corner({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                            {{0, 2, 1}, {0, 1, 3}});
  const auto links = CalcFaceLinks(corner);
  ASSERT_EQ(links.size(), 1u);
  EXPECT_NEAR(links[0].angle, -std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(links[0].length, 1.0, 1e-12);
}

TEST(CalcComponents, NumbersConnectedFacesOfOneLabel) {
  const TriangleMesh strip = MakeStrip(3);
  const auto links = CalcFaceLinks(strip);
  EXPECT_EQ(CalcComponents({0, 0, 1, 1, 0, 0}, links),
            (std::vector<int>{0, 0, 1, 1, 2, 2}));
  EXPECT_EQ(CalcComponents({5, 5, 5, 5, 5, 5}, links),
            (std::vector<int>{0, 0, 0, 0, 0, 0}));
}

TEST(MergeIslands, GivesSmallPiecesToTheirNeighbourOnly) {
  const TriangleMesh strip = MakeStrip(20);
  const auto links = CalcFaceLinks(strip);
  std::vector<int> labels(40, 0);
  std::fill(labels.begin() + 20, labels.end(), 1);
  labels[5] = 1;  // One face of label 1 inside label 0: 1/21 of its area.
  const std::vector<int> merged = MergeIslands(strip, links, labels, 0.06);
  EXPECT_EQ(std::count(merged.begin(), merged.end(), 0), 20);
  EXPECT_EQ(merged[5], 0);
  EXPECT_EQ(MergeIslands(strip, links, labels, 0.04), labels);
}

TEST(MergeIslands, PrefersTheLongestBorderAndEndsWithIslandsBesideIslands) {
  const TriangleMesh strip = MakeStrip(30);
  std::vector<int> labels(60, 0);
  labels[10] = 1;
  labels[11] = 2;
  std::fill(labels.begin() + 50, labels.end(), 2);
  std::fill(labels.begin() + 40, labels.begin() + 50, 1);
  const std::vector<int> merged =
      MergeIslands(strip, CalcFaceLinks(strip), labels, 0.2);
  EXPECT_EQ(std::count(merged.begin(), merged.end(), 0), 40);
}

}  // namespace
}  // namespace graspdb
