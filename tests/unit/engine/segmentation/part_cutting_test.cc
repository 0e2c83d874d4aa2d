#include "engine/segmentation/part_cutting.h"

#include <algorithm>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "engine/base/contract.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// Labels faces 0 or 1 by which side of z = 0 they lie on.
LabelledMesh SplitByHeight(TriangleMesh mesh) {
  LabelledMesh object{std::move(mesh), {}};
  for (int f = 0; f < object.mesh_O.num_triangles(); ++f) {
    object.face_labels.push_back(object.mesh_O.centroid(f).z() > 0.0 ? 1 : 0);
  }
  return object;
}

PartVocabulary MakeVocabulary() { return {{"lower", "upper"}, {{0, 1}}}; }

// True when an edge of triangle a passes through the inside of triangle b.
bool Pierces(const TriangleMesh& mesh, int a, int b) {
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d& start = mesh.corner(a, k);
    const Eigen::Vector3d& end = mesh.corner(a, (k + 1) % 3);
    const double from = mesh.normal(b).dot(start - mesh.corner(b, 0));
    const double to = mesh.normal(b).dot(end - mesh.corner(b, 0));
    constexpr double kTolerance = 1e-7;  // Metres: touching is no piercing.
    if (std::min(from, to) > -kTolerance || std::max(from, to) < kTolerance) {
      continue;
    }
    const Eigen::Vector3d p = start + (end - start) * (from / (from - to));
    bool inside = true;
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d side =
          mesh.corner(b, (j + 1) % 3) - mesh.corner(b, j);
      inside &= side.cross(p - mesh.corner(b, j)).dot(mesh.normal(b)) >
                kTolerance * side.norm();
    }
    if (inside) return true;
  }
  return false;
}

int CountPiercedCaps(const Part& part) {
  const TriangleMesh& mesh = part.solid_O;
  int count = 0;
  for (int cap = part.num_surface_faces; cap < mesh.num_triangles(); ++cap) {
    for (int f = 0; f < mesh.num_triangles(); ++f) {
      if (f != cap && (Pierces(mesh, f, cap) || Pierces(mesh, cap, f))) ++count;
    }
  }
  return count;
}

void ExpectSurfaceFirst(const LabelledMesh& object, const Part& part) {
  ASSERT_EQ(static_cast<int>(part.object_faces.size()), part.num_surface_faces);
  for (int f = 0; f < part.num_surface_faces; ++f) {
    const int source = part.object_faces[f];
    EXPECT_EQ(object.face_labels[source], part.label);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(part.solid_O.corner(f, k), object.mesh_O.corner(source, k));
    }
  }
}

TEST(CutIntoParts, MakesTwoHalvesOfACylinder) {
  const LabelledMesh object =
      SplitByHeight(workshop::MakeCylinder(0.1, 0.4, 32, 8));
  const auto parts = CutIntoParts(object, MakeVocabulary());
  ASSERT_TRUE(parts);
  ASSERT_EQ(parts->size(), 2u);
  const double whole = CalcMassProperties(object.mesh_O).volume;
  for (int label = 0; label < 2; ++label) {
    const Part& part = (*parts)[label];
    EXPECT_EQ(part.label, label);
    ExpectSurfaceFirst(object, part);
    EXPECT_TRUE(IsClosed(part.solid_O));
    EXPECT_NEAR(CalcMassProperties(part.solid_O).volume, 0.5 * whole, 1e-12);
    // A ring of 32 corners is closed by 30 triangles, all facing the cut.
    EXPECT_EQ(part.solid_O.num_triangles() - part.num_surface_faces, 30);
    for (int f = part.num_surface_faces; f < part.solid_O.num_triangles();
         ++f) {
      EXPECT_NEAR(part.solid_O.normal(f).z(), label == 0 ? 1.0 : -1.0, 1e-12);
    }
    EXPECT_EQ(CountPiercedCaps(part), 0);
  }
}

TEST(CutIntoParts, KeepsAnObjectOfOneLabelAsItIs) {
  const LabelledMesh object{workshop::MakeBox({1, 1, 1}),
                            std::vector<int>(12, 1)};
  const auto parts = CutIntoParts(object, MakeVocabulary());
  ASSERT_TRUE(parts);
  ASSERT_EQ(parts->size(), 1u);
  EXPECT_EQ(parts->front().label, 1);
  EXPECT_EQ(parts->front().num_surface_faces, 12);
  EXPECT_EQ(parts->front().solid_O.num_triangles(), 12);
  EXPECT_NEAR(CalcMassProperties(parts->front().solid_O).volume, 1.0, 1e-12);
}

TEST(CutIntoParts, ClosesPiecesThatTouchInOneVertex) {
  // Label 1: two opposite quarters of a sphere's side, meeting at the poles and
  // nowhere else.
  LabelledMesh object{workshop::MakeSphere(1.0, 16), {}};
  for (int f = 0; f < object.mesh_O.num_triangles(); ++f) {
    const Eigen::Vector3d p = object.mesh_O.centroid(f);
    object.face_labels.push_back(p.x() * p.y() > 0.0 ? 1 : 0);
  }
  const auto parts = CutIntoParts(object, MakeVocabulary());
  ASSERT_TRUE(parts);
  ASSERT_EQ(parts->size(), 2u);
  for (const Part& part : *parts) {
    ExpectSurfaceFirst(object, part);
    EXPECT_TRUE(IsClosed(part.solid_O));
    EXPECT_GT(CalcMassProperties(part.solid_O).volume, 0.5);
  }
}

TEST(CutIntoParts, ClosesBothSidesOfACutAlike) {
  // Two neighbouring faces of an octahedron against the other six: joining the
  // ends of their common edge is not allowed, though the shorter way for the
  // six.
  const TriangleMesh octahedron(
      {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 1, 4},
       {1, 2, 4},
       {2, 3, 4},
       {3, 0, 4},
       {1, 0, 5},
       {2, 1, 5},
       {3, 2, 5},
       {0, 3, 5}});
  const auto parts =
      CutIntoParts({octahedron, {1, 1, 0, 0, 0, 0, 0, 0}}, MakeVocabulary());
  ASSERT_TRUE(parts);
  EXPECT_NEAR(CalcMassProperties(parts->at(0).solid_O).volume, 1.0, 1e-12);
  EXPECT_NEAR(CalcMassProperties(parts->at(1).solid_O).volume, 1.0 / 3, 1e-12);
}

TEST(CutIntoParts, ClosesALoopWhoseChordsAreAllTaken) {
  // In a tetrahedron every two vertices are joined already: each pair of faces
  // is closed by a fan from the middle, and both have half the volume.
  const TriangleMesh tetrahedron({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                 {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
  const auto parts =
      CutIntoParts({tetrahedron, {0, 0, 1, 1}}, MakeVocabulary());
  ASSERT_TRUE(parts);
  ASSERT_EQ(parts->size(), 2u);
  for (const Part& part : *parts) {
    EXPECT_TRUE(IsClosed(part.solid_O));
    EXPECT_EQ(part.solid_O.num_triangles(), 2 + 4);
    EXPECT_NEAR(CalcMassProperties(part.solid_O).volume, 1.0 / 12, 1e-12);
  }
}

TEST(CutIntoParts, RefusesAPartThatIsNoSolid) {
  LabelledMesh object{workshop::MakeBox({1, 1, 1}), std::vector<int>(12, 0)};
  object.face_labels[3] = 1;  // One triangle.
  const auto parts = CutIntoParts(object, MakeVocabulary());
  ASSERT_FALSE(parts);
  EXPECT_EQ(parts.error().code, ErrorCode::kUnusableInput);
  EXPECT_NE(parts.error().message.find("upper"), std::string::npos);
}

TEST(CutIntoParts, RefusesLabelsOutsideTheVocabulary) {
  LabelledMesh object{workshop::MakeBox({1, 1, 1}), std::vector<int>(12, 2)};
  EXPECT_THROW(CutIntoParts(object, MakeVocabulary()).has_value(),
               ContractViolation);
  object.face_labels.assign(11, 0);
  EXPECT_THROW(CutIntoParts(object, MakeVocabulary()).has_value(),
               ContractViolation);
}

class CutMug : public testing::TestWithParam<std::string> {};

TEST_P(CutMug, GivesTwoSolidsThatFillTheMugAndDoNotCutThemselves) {
  const LabelledMesh mug = workshop::LoadMug(GetParam());
  const auto parts = CutIntoParts(mug, workshop::MakeMugVocabulary());
  ASSERT_TRUE(parts);
  ASSERT_EQ(parts->size(), 2u);
  double volume = 0.0;
  for (const Part& part : *parts) {
    ExpectSurfaceFirst(mug, part);
    EXPECT_TRUE(IsClosed(part.solid_O));
    EXPECT_GT(part.solid_O.num_triangles(), part.num_surface_faces);
    EXPECT_EQ(CountPiercedCaps(part), 0);
    volume += CalcMassProperties(part.solid_O).volume;
  }
  EXPECT_NEAR(volume, CalcMassProperties(mug.mesh_O).volume, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Mugs, CutMug,
                         testing::Values("classic", "latte", "bowl", "square",
                                         "cone"),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace graspdb
