#include "engine/segmentation/part_segmentation.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/contract.h"
#include "engine/base/random.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

constexpr int kBody = 0;
constexpr int kHandle = 1;

SegmentationResult Segment(
    const TriangleMesh& mesh,
    const std::vector<std::string>& examples = {"classic"},
    const SegmentationParameters& parameters = {}) {
  std::vector<LabelledMesh> loaded;
  for (const std::string& name : examples) {
    loaded.push_back(workshop::LoadMug(name));
  }
  ExecutionContext context;
  return SegmentObject(mesh, workshop::MakeMugVocabulary(), loaded, parameters,
                       1, context)
      .value();
}

// The area in which both have the label, over that in which either has.
double CalcAgreement(const TriangleMesh& mesh, const std::vector<int>& a,
                     const std::vector<int>& b, int label) {
  double both = 0.0;
  double either = 0.0;
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    if (a[f] == label && b[f] == label) both += mesh.area(f);
    if (a[f] == label || b[f] == label) either += mesh.area(f);
  }
  return both / either;
}

bool Mentions(const SegmentationResult& result, const std::string& words) {
  return std::any_of(result.warnings.begin(), result.warnings.end(),
                     [&](const std::string& warning) {
                       return warning.find(words) != std::string::npos;
                     });
}

class SegmentNovelMug : public testing::TestWithParam<std::string> {};

TEST_P(SegmentNovelMug, AgreesWithTheLabelsByHand) {
  const LabelledMesh mug = workshop::LoadMug(GetParam());
  const SegmentationResult result = Segment(mug.mesh_O);
  EXPECT_EQ(result.verdict, SegmentationVerdict::kMatched);
  EXPECT_THAT(result.warnings, testing::IsEmpty());
  for (const int label : {kBody, kHandle}) {
    EXPECT_GE(
        CalcAgreement(mug.mesh_O, result.face_labels, mug.face_labels, label),
        0.95);
  }
  ASSERT_EQ(result.parts.size(), 2u);
  for (const int label : {kBody, kHandle}) {
    EXPECT_EQ(result.parts[label].label, label);
    EXPECT_TRUE(IsClosed(result.parts[label].solid_O));
    EXPECT_GT(result.parts[label].confidence, 0.8);
  }
  EXPECT_GT(result.similarity, 0.15);
}

TEST_P(SegmentNovelMug, GivesTheSameInAnyPoseAndUnit) {
  const TriangleMesh mug = workshop::LoadMug(GetParam()).mesh_O;
  Random random(4);
  const RigidTransform X_AN{random.NextRotation(), {0.3, -0.2, 0.1}};
  const SegmentationResult before = Segment(mug);
  const SegmentationResult after = Segment(CalcTransformed(mug, X_AN, 25.4));
  EXPECT_EQ(after.verdict, before.verdict);
  for (const int label : {kBody, kHandle}) {
    EXPECT_GE(CalcAgreement(mug, after.face_labels, before.face_labels, label),
              0.999);
  }
  EXPECT_NEAR(after.residual, before.residual, 0.002);
}

TEST_P(SegmentNovelMug, FindsTheHandleByShapeDiameterToo) {
  const LabelledMesh mug = workshop::LoadMug(GetParam());
  SegmentationParameters parameters;
  parameters.by_shape_diameter = true;
  const SegmentationResult result =
      Segment(mug.mesh_O, {"classic"}, parameters);
  EXPECT_EQ(result.parts.size(), 2u);
  EXPECT_GE(
      CalcAgreement(mug.mesh_O, result.face_labels, mug.face_labels, kHandle),
      0.9);
}

INSTANTIATE_TEST_SUITE_P(Mugs, SegmentNovelMug,
                         testing::Values("latte", "bowl", "square", "cone"),
                         [](const auto& tested) { return tested.param; });

TEST(SegmentObject, ReproducesTheExampleItself) {
  const LabelledMesh mug = workshop::LoadMug("classic");
  const SegmentationResult result = Segment(mug.mesh_O);
  EXPECT_EQ(result.face_labels, mug.face_labels);
  EXPECT_NEAR(result.residual, 0.0, 1e-9);
  EXPECT_NEAR(result.similarity, 1.0, 1e-6);
  EXPECT_NEAR(result.scale, 1.0, 1e-6);
  EXPECT_LT(CalcRotationAngle(result.X_NE.rotation), 1e-4);
}

TEST(SegmentObject, TakesTheExampleThatFitsBest) {
  const TriangleMesh mug = workshop::LoadMug("square").mesh_O;
  const SegmentationResult result = Segment(mug, {"cone", "square", "classic"});
  EXPECT_EQ(result.example, 1);
  EXPECT_NEAR(result.residual, 0.0, 1e-9);
}

TEST(SegmentObject, GivesTheSameBytesEachTime) {
  const TriangleMesh mug = workshop::LoadMug("bowl").mesh_O;
  const SegmentationResult a = Segment(mug);
  const SegmentationResult b = Segment(mug);
  EXPECT_EQ(a.face_labels, b.face_labels);
  EXPECT_EQ(a.X_NE, b.X_NE);
  EXPECT_EQ(a.residual, b.residual);
  for (size_t i = 0; i < a.parts.size(); ++i) {
    EXPECT_EQ(a.parts[i].solid_O, b.parts[i].solid_O);
  }
}

TEST(SegmentObject, RefusesForeignShapesInWords) {
  for (const TriangleMesh& mesh :
       {workshop::MakeBox({0.3, 0.02, 0.02}, 20),
        workshop::MakeSphere(0.05, 24), workshop::MakeCylinder(0.04, 0.2),
        workshop::MakeBox({0.1, 0.1, 0.1}, 10)}) {
    const SegmentationResult result = Segment(mesh);
    EXPECT_EQ(result.verdict, SegmentationVerdict::kForeign);
    EXPECT_FALSE(result.warnings.empty());
    EXPECT_LT(result.similarity, 0.5);
  }
  EXPECT_TRUE(
      Mentions(Segment(workshop::MakeBox({0.3, 0.02, 0.02}, 20)), "residual"));
}

TEST(SegmentObject, IsUnsureWhenThePartsDoNotTouchAsTheyShould) {
  // Body and handle cut apart and capped: they no longer share an edge.
  const LabelledMesh mug = workshop::LoadMug("classic");
  const auto parts = CutIntoParts(mug, workshop::MakeMugVocabulary());
  const TriangleMesh apart =
      CalcUnion({parts->at(kBody).solid_O, parts->at(kHandle).solid_O});
  const SegmentationResult result = Segment(apart);
  EXPECT_EQ(result.verdict, SegmentationVerdict::kUnsure);
  EXPECT_TRUE(Mentions(result, "the body and the handle do not touch"));
}

TEST(SegmentObject, IsUnsureBelowTheConfidenceAskedFor) {
  SegmentationParameters parameters;
  parameters.min_confidence = 1.0;
  const SegmentationResult result =
      Segment(workshop::LoadMug("latte").mesh_O, {"classic"}, parameters);
  EXPECT_EQ(result.verdict, SegmentationVerdict::kUnsure);
  EXPECT_TRUE(Mentions(result, "confidence"));
}

TEST(SegmentObject, StopsWhenCancelled) {
  const LabelledMesh mug = workshop::LoadMug("classic");
  ExecutionContext context;
  context.Cancel();
  const auto result = SegmentObject(mug.mesh_O, workshop::MakeMugVocabulary(),
                                    {mug}, {}, 1, context);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kCancelled);
}

TEST(SegmentObject, NeedsAnExample) {
  ExecutionContext context;
  EXPECT_THROW(SegmentObject(workshop::MakeBox({1, 1, 1}),
                             workshop::MakeMugVocabulary(), {}, {}, 1, context)
                   .has_value(),
               ContractViolation);
}

class SegmentExtraObjects : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("GRASPDB_EXTRA_OBJECTS") == nullptr) {
      GTEST_SKIP() << "other people's meshes are not in the repository: "
                      "GRASPDB_EXTRA_OBJECTS names a folder";
    }
  }

  // The closed meshes of mug/, bottle/, bowl/ … in that folder.
  static std::vector<std::pair<std::string, TriangleMesh>> Load(
      const std::vector<std::string>& categories) {
    std::vector<std::pair<std::string, TriangleMesh>> meshes;
    const std::filesystem::path folder = std::getenv("GRASPDB_EXTRA_OBJECTS");
    for (const std::string& category : categories) {
      const auto path = folder / category;
      if (!std::filesystem::exists(path)) continue;
      for (const auto& file : std::filesystem::directory_iterator(path)) {
        if (file.path().extension() != ".obj") continue;
        TriangleMesh mesh = workshop::LoadObj(file.path());
        if (IsClosed(mesh)) meshes.emplace_back(file.path(), std::move(mesh));
      }
    }
    EXPECT_FALSE(meshes.empty()) << folder << " has none of these";
    return meshes;
  }
};

TEST_F(SegmentExtraObjects, FindsBodyAndHandleOfEveryClosedMug) {
  for (const auto& [name, mesh] : Load({"mug"})) {
    for (const bool by_shape_diameter : {false, true}) {
      SegmentationParameters parameters;
      parameters.by_shape_diameter = by_shape_diameter;
      const SegmentationResult result = Segment(mesh, {"classic"}, parameters);
      EXPECT_EQ(result.verdict, SegmentationVerdict::kMatched) << name;
      EXPECT_EQ(result.parts.size(), 2u) << name;
    }
  }
}

TEST_F(SegmentExtraObjects, RefusesWhatIsNoMug) {
  for (const auto& [name, mesh] :
       Load({"banana", "bottle", "bowl", "hammer", "knife", "power_drill",
             "screwdriver", "spray_bottle", "wine_glass"})) {
    EXPECT_EQ(Segment(mesh).verdict, SegmentationVerdict::kForeign) << name;
  }
}

}  // namespace
}  // namespace graspdb
