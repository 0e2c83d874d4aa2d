#include "engine/registration/surface_alignment.h"

#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "engine/base/contract.h"
#include "engine/base/random.h"
#include "engine/geometry/surface_sampling.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

RigidTransform MakeRandomPose(uint64_t seed) {
  Random random(seed);
  return {random.NextRotation(), 0.5 * random.NextInUnitBall()};
}

double CalcAngleBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return CalcRotationAngle(a.transpose() * b);
}

SurfaceSamples PickLabel(const SurfaceSamples& samples,
                         const std::vector<int>& face_labels, int label) {
  SurfaceSamples picked;
  for (int i = 0; i < samples.size(); ++i) {
    if (face_labels[samples.faces[i]] != label) continue;
    picked.points.push_back(samples.points[i]);
    picked.normals.push_back(samples.normals[i]);
    picked.faces.push_back(samples.faces[i]);
  }
  return picked;
}

// Four points on the unit circle, normals outward: rms radius 1.
SurfaceSamples MakeCross() {
  SurfaceSamples cross;
  cross.points = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  cross.normals = cross.points;
  cross.faces = {0, 1, 2, 3};
  return cross;
}

TEST(CalcAlignmentDeviation, IsThePapersSumWithLengthsOverTheRmsRadius) {
  // Each point is 0.1 radii off; one normal is 30 degrees off.
  SurfaceSamples samples_E = MakeCross();
  for (Eigen::Vector3d& p : samples_E.points) p *= 1.1;
  samples_E.normals[0] = {std::cos(30 * kDegree), 0, std::sin(30 * kDegree)};
  const double expected =
      4 * 0.01 + 0.25 * (std::numbers::pi / 6) * (std::numbers::pi / 6);
  EXPECT_NEAR(CalcAlignmentDeviation(samples_E, MakeCross(), {}, 0.5), expected,
              1e-6);
  // The unit of length does not matter.
  SurfaceSamples samples_N = MakeCross();
  for (Eigen::Vector3d& p : samples_N.points) p *= 1000;
  for (Eigen::Vector3d& p : samples_E.points) p *= 1000;
  EXPECT_NEAR(CalcAlignmentDeviation(samples_E, samples_N, {}, 0.5), expected,
              1e-6);
}

TEST(CalcAlignmentDeviation, VanishesWhereTheAlignmentIsExact) {
  const RigidTransform X_NE = MakeRandomPose(3);
  SurfaceSamples samples_N = MakeCross();
  for (int i = 0; i < 4; ++i) {
    samples_N.points[i] = X_NE * Eigen::Vector3d(2.0 * samples_N.points[i]);
    samples_N.normals[i] = X_NE.rotation * samples_N.normals[i];
  }
  SurfaceAlignment alignment;
  alignment.X_NE = X_NE;
  alignment.scale = 2.0;
  EXPECT_NEAR(CalcAlignmentDeviation(MakeCross(), samples_N, alignment, 0.5), 0,
              1e-9);
}

class AlignmentOfAMovedMug : public testing::TestWithParam<uint64_t> {};

TEST_P(AlignmentOfAMovedMug, RecoversPoseAndScale) {
  const TriangleMesh mug = workshop::LoadMug("classic").mesh_O;
  const RigidTransform X_NE = MakeRandomPose(GetParam());
  const double scale = 1000.0;  // A mug in millimetres.
  const SurfaceSamples samples_E = SampleSurface(mug, 1500, 1);
  const SurfaceSamples samples_N =
      SampleSurface(CalcTransformed(mug, X_NE, scale), 1500, 2);
  const SurfaceAlignment alignment = AlignSurfaces(samples_E, samples_N, {});
  EXPECT_LT(CalcAngleBetween(alignment.X_NE.rotation, X_NE.rotation),
            2 * kDegree);
  EXPECT_NEAR(alignment.scale / scale, 1.0, 0.01);
  EXPECT_LT(alignment.residual, 0.01);
  for (const Eigen::Vector3d& p_E : samples_E.points) {
    const Eigen::Vector3d p_N = X_NE * Eigen::Vector3d(scale * p_E);
    EXPECT_LT((alignment * p_E - p_N).norm(), 0.003 * scale);
    EXPECT_LT((alignment.map_NE * p_E - p_N).norm(), 0.004 * scale);
  }
}

TEST_P(AlignmentOfAMovedMug, RecoversTheRigidPose) {
  const TriangleMesh mug = workshop::LoadMug("classic").mesh_O;
  const RigidTransform X_NE = MakeRandomPose(GetParam());
  AlignmentOptions options;
  options.scale = false;
  const SurfaceAlignment alignment = AlignSurfaces(
      SampleSurface(mug, 1500, 1),
      SampleSurface(CalcTransformed(mug, X_NE), 1500, 2), options);
  EXPECT_EQ(alignment.scale, 1.0);
  EXPECT_LT(CalcAngleBetween(alignment.X_NE.rotation, X_NE.rotation),
            2 * kDegree);
  EXPECT_LT((alignment.X_NE.translation - X_NE.translation).norm(), 0.003);
  EXPECT_TRUE(alignment.map_NE.linear.isApprox(alignment.X_NE.rotation, 1e-12));
}

INSTANTIATE_TEST_SUITE_P(Poses, AlignmentOfAMovedMug,
                         testing::Values(11, 12, 13, 14, 15, 16));

class AlignmentWithAnotherMug : public testing::TestWithParam<std::string> {};

// All bundled mugs stand upright with the handle on the same side.
TEST_P(AlignmentWithAnotherMug, PutsBodyOnBodyAndHandleOnHandle) {
  const LabelledMesh example = workshop::LoadMug("classic");
  const LabelledMesh novel = workshop::LoadMug(GetParam());
  const RigidTransform X_NO = MakeRandomPose(5);
  const SurfaceAlignment alignment = AlignSurfaces(
      SampleSurface(example.mesh_O, 1500, 1),
      SampleSurface(CalcTransformed(novel.mesh_O, X_NO), 1500, 1), {});
  EXPECT_LT(CalcAngleBetween(alignment.X_NE.rotation, X_NO.rotation),
            20 * kDegree);
}

TEST_P(AlignmentWithAnotherMug, GivesTheBodyTheRotationThatTheHandleFixes) {
  const LabelledMesh example = workshop::LoadMug("classic");
  const LabelledMesh novel = workshop::LoadMug(GetParam());
  const SurfaceSamples samples_E = SampleSurface(example.mesh_O, 1500, 1);
  const SurfaceSamples samples_N = SampleSurface(novel.mesh_O, 1500, 1);
  const SurfaceAlignment whole = AlignSurfaces(samples_E, samples_N, {});
  const SurfaceAlignment body =
      RefineAlignment(PickLabel(samples_E, example.face_labels, 0),
                      PickLabel(samples_N, novel.face_labels, 0), whole, {});
  EXPECT_LT(CalcAngleBetween(body.X_NE.rotation, whole.X_NE.rotation),
            8 * kDegree);
  EXPECT_LE(body.residual, 0.15);
}

INSTANTIATE_TEST_SUITE_P(Mugs, AlignmentWithAnotherMug,
                         testing::Values("latte", "bowl", "square", "cone"),
                         [](const auto& tested) { return tested.param; });

TEST(AlignSurfaces, DoesNotDependOnThePoseOfEither) {
  const TriangleMesh mesh_E = workshop::LoadMug("classic").mesh_O;
  const TriangleMesh mesh_N = workshop::LoadMug("square").mesh_O;
  const RigidTransform X_AE = MakeRandomPose(21);
  const RigidTransform X_BN = MakeRandomPose(22);
  const SurfaceAlignment before = AlignSurfaces(
      SampleSurface(mesh_E, 1500, 1), SampleSurface(mesh_N, 1500, 1), {});
  const SurfaceAlignment after =
      AlignSurfaces(SampleSurface(CalcTransformed(mesh_E, X_AE), 1500, 1),
                    SampleSurface(CalcTransformed(mesh_N, X_BN), 1500, 1), {});
  const RigidTransform X_NE = X_BN.Inverse() * after.X_NE * X_AE;
  EXPECT_LT(CalcAngleBetween(X_NE.rotation, before.X_NE.rotation), 1 * kDegree);
  EXPECT_NEAR(after.residual, before.residual, 1e-3);
}

TEST(AlignSurfaces, GivesTheSameBytesEachTime) {
  const SurfaceSamples samples_E =
      SampleSurface(workshop::LoadMug("classic").mesh_O, 600, 1);
  const SurfaceSamples samples_N =
      SampleSurface(workshop::LoadMug("latte").mesh_O, 600, 1);
  EXPECT_EQ(AlignSurfaces(samples_E, samples_N, {}),
            AlignSurfaces(samples_E, samples_N, {}));
}

TEST(AlignSurfaces, TriesOnlyTheGivenRotations) {
  // From an upside-down start the handle still goes to the handle, so that the
  // mug stays upside down.
  const SurfaceSamples samples =
      SampleSurface(workshop::LoadMug("classic").mesh_O, 600, 1);
  AlignmentOptions options;
  options.start_rotations = {
      Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX())
          .toRotationMatrix()};
  const SurfaceAlignment alignment = AlignSurfaces(samples, samples, options);
  EXPECT_GT(CalcRotationAngle(alignment.X_NE.rotation), 150 * kDegree);
}

TEST(AlignSurfaces, LeavesALargeResidualBetweenForeignShapes) {
  const SurfaceSamples mug =
      SampleSurface(workshop::LoadMug("classic").mesh_O, 1500, 1);
  const SurfaceSamples bar =
      SampleSurface(workshop::MakeBox({0.3, 0.02, 0.02}, 10), 1500, 1);
  EXPECT_GT(AlignSurfaces(mug, bar, {}).residual, 0.13);
}

TEST(CalcSimilarity, HalvesWithEachLimitOfDissimilarity) {
  SurfaceAlignment alignment;
  EXPECT_EQ(CalcSimilarity(alignment, 0.05), 1.0);
  alignment.residual = 0.02;
  alignment.unstretched_residual = 0.1;
  EXPECT_NEAR(CalcDissimilarity(alignment), 0.05, 1e-12);
  EXPECT_NEAR(CalcSimilarity(alignment, 0.05), 0.5, 1e-12);
  EXPECT_NEAR(CalcSimilarity(alignment, 0.025), 0.25, 1e-12);
}

TEST(CalcDissimilarity, SeesTheStretchThatTheResidualForgives) {
  const TriangleMesh bar = workshop::MakeBox({0.3, 0.06, 0.06}, 20);
  std::vector<Eigen::Vector3d> vertices = bar.vertices();
  for (Eigen::Vector3d& p : vertices) p.x() *= 0.6;
  const TriangleMesh squeezed(vertices, bar.triangles());
  const SurfaceAlignment alignment = AlignSurfaces(
      SampleSurface(bar, 1000, 1), SampleSurface(squeezed, 1000, 1), {});
  EXPECT_LT(alignment.residual, 0.01);
  EXPECT_GT(alignment.unstretched_residual, 5.0 * alignment.residual);
  EXPECT_GT(CalcDissimilarity(alignment), 2.0 * alignment.residual);
}

TEST(AlignSurfaces, RefusesTooFewSamples) {
  SurfaceSamples few = MakeCross();
  few.points.pop_back();
  EXPECT_THROW(AlignSurfaces(few, MakeCross(), {}), ContractViolation);
  EXPECT_THROW(RefineAlignment(MakeCross(), few, {}, {}), ContractViolation);
}

TEST(AlignSurfaces, FindsThePoseOfASurfaceThatIsSeenFromOneSide) {
  const TriangleMesh mug = workshop::LoadMug("classic").mesh_O;
  const RigidTransform X_NE = MakeRandomPose(9);
  const SurfaceSamples all = SampleSurface(CalcTransformed(mug, X_NE), 3000, 2);
  SurfaceSamples seen;
  for (int i = 0; i < all.size(); ++i) {
    if ((X_NE.rotation.transpose() * all.normals[i]).y() > -0.2) continue;
    seen.points.push_back(all.points[i]);
    seen.normals.push_back(all.normals[i]);
    seen.faces.push_back(all.faces[i]);
  }
  AlignmentOptions options;
  options.partial_N = true;
  const SurfaceAlignment found =
      AlignSurfaces(SampleSurface(mug, 1500, 1), seen, options);
  EXPECT_LT(found.residual, 0.01);
  EXPECT_LT(CalcAngleBetween(found.X_NE.rotation, X_NE.rotation), 5 * kDegree);
  options.partial_N = false;
  EXPECT_GT(AlignSurfaces(SampleSurface(mug, 1500, 1), seen, options).residual,
            5.0 * found.residual);
}

}  // namespace
}  // namespace graspdb
