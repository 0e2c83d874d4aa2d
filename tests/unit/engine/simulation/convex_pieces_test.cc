#include "engine/simulation/convex_pieces.h"

#include <array>
#include <set>

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "engine/geometry/surface_index.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

constexpr double kConcavity = 0.001;

// A random point of a piece's hull.
Eigen::Vector3d Draw(const std::vector<Eigen::Vector3d>& piece,
                     Random& random) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weight = 0.0;
  for (int i = 0; i < 4; ++i) {
    const double w = random.NextUniform(0.0, 1.0);
    sum += w * piece[static_cast<size_t>(
                   random.NextIndex(static_cast<int>(piece.size())))];
    weight += w;
  }
  return sum / weight;
}

TEST(ConvexPieces, AConvexSolidIsOne) {
  EXPECT_EQ(MakeConvexPieces(workshop::MakeBox({0.05, 0.04, 0.03}, 4)).size(),
            1u);
  EXPECT_EQ(MakeConvexPieces(workshop::MakeSphere(0.04, 16)).size(), 1u);
}

TEST(ConvexPieces, CoverTheSurface) {
  const TriangleMesh mug = workshop::LoadMug("classic").mesh_O;
  std::set<std::array<double, 3>> points;
  for (const auto& piece : MakeConvexPieces(mug)) {
    for (const Eigen::Vector3d& p : piece) points.insert({p.x(), p.y(), p.z()});
  }
  for (const Eigen::Vector3d& p : mug.vertices()) {
    EXPECT_TRUE(points.contains({p.x(), p.y(), p.z()}));
  }
}

TEST(ConvexPieces, StandOutOfTheSolidByLittleSoThatTheHandleStaysOpen) {
  const TriangleMesh mug = workshop::LoadMug("classic").mesh_O;
  const SurfaceIndex index(mug);
  Random random(3);
  for (const auto& piece : MakeConvexPieces(mug, kConcavity)) {
    ASSERT_GE(piece.size(), 6u);
    for (int i = 0; i < 40; ++i) {
      EXPECT_LT(index.CalcSignedDistance(Draw(piece, random)),
                1.5 * kConcavity);
    }
  }
}

TEST(ConvexPieces, AreTheSameEachTime) {
  const TriangleMesh mug = workshop::LoadMug("bowl").mesh_O;
  EXPECT_EQ(MakeConvexPieces(mug), MakeConvexPieces(mug));
}

}  // namespace
}  // namespace graspdb
