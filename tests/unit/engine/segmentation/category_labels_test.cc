// How well labels carry over to every novel object of data/: as it is, turned,
// coarse, fine, and with noise.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/admission/mesh_decimation.h"
#include "engine/base/random.h"
#include "engine/geometry/subdivision.h"
#include "engine/geometry/surface_index.h"
#include "engine/geometry/surface_sampling.h"
#include "engine/segmentation/part_segmentation.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

LabelledMesh Refine(const LabelledMesh& coarse) {
  LabelledMesh fine{Subdivide(coarse.mesh_O), {}};
  for (const int label : coarse.face_labels) {
    fine.face_labels.insert(fine.face_labels.end(), 4, label);
  }
  return fine;
}

LabelledMesh Coarsen(const LabelledMesh& fine, int triangles) {
  LabelledMesh coarse{Decimate(fine.mesh_O, triangles).value(), {}};
  const SurfaceIndex index(fine.mesh_O);
  for (int f = 0; f < coarse.mesh_O.num_triangles(); ++f) {
    coarse.face_labels.push_back(
        fine.face_labels[index.FindClosest(coarse.mesh_O.centroid(f))->face]);
  }
  return coarse;
}

LabelledMesh AddNoise(const LabelledMesh& clean, double deviation) {
  Random random(3);
  std::vector<Eigen::Vector3d> vertices = clean.mesh_O.vertices();
  for (Eigen::Vector3d& p : vertices) {
    for (double& x : p) x += deviation * random.NextNormal();
  }
  return {TriangleMesh(std::move(vertices), clean.mesh_O.triangles()),
          clean.face_labels};
}

LabelledMesh Turn(const LabelledMesh& object, uint64_t seed) {
  Random random(seed);
  const RigidTransform X{random.NextRotation(), random.NextInUnitBall()};
  return {CalcTransformed(object.mesh_O, X), object.face_labels};
}

struct Outcome {
  double agreement{0.0};  // Share of the area whose label is right.
  SegmentationVerdict verdict{SegmentationVerdict::kForeign};
};

class CategoryLabels : public ::testing::TestWithParam<const char*> {
 protected:
  CategoryLabels() : category_(workshop::LoadCategory(GetParam())) {
    for (const std::string& name : category_.examples) {
      examples_.push_back(workshop::LoadObject(category_.name, name));
    }
  }

  Outcome Segment(const LabelledMesh& object,
                  const SeenSurface* seen = nullptr) const {
    ExecutionContext context;
    const auto result =
        SegmentObject(object.mesh_O, category_.vocabulary, examples_,
                      category_.segmentation, 1, context, seen);
    if (!result) return {};
    Outcome outcome{0.0, result->verdict};
    for (int f = 0; f < object.mesh_O.num_triangles(); ++f) {
      if (result->face_labels[f] == object.face_labels[f]) {
        outcome.agreement += object.mesh_O.area(f) / object.mesh_O.total_area();
      }
    }
    return outcome;
  }

  const workshop::Category category_;
  std::vector<LabelledMesh> examples_;
};

TEST_P(CategoryLabels, OfCleanObjectsAreRight) {
  for (const std::string& name : category_.novel) {
    SCOPED_TRACE(name);
    const Outcome outcome = Segment(workshop::LoadObject(category_.name, name));
    EXPECT_EQ(outcome.verdict, SegmentationVerdict::kMatched);
    EXPECT_GE(outcome.agreement, 0.95);
    RecordProperty(name, std::to_string(outcome.agreement));
  }
}

TEST_P(CategoryLabels, OfTurnedCoarseFineAndNoisyObjectsAreRight) {
  for (const std::string& name : category_.novel) {
    const LabelledMesh object = workshop::LoadObject(category_.name, name);
    LabelledMesh fine = object;
    while (fine.mesh_O.num_triangles() < 12'500) fine = Refine(fine);
    fine = Refine(fine);
    const std::pair<const char*, LabelledMesh> variants[] = {
        {"turned", Turn(object, 5)},
        {"coarse", Turn(Coarsen(object, 700), 6)},
        {"fine", Turn(fine, 7)},
        {"noisy", Turn(AddNoise(object, 0.001), 8)}};
    for (const auto& [kind, variant] : variants) {
      const Outcome outcome = Segment(variant);
      EXPECT_NE(outcome.verdict, SegmentationVerdict::kForeign)
          << name << ", " << kind;
      EXPECT_GE(outcome.agreement, 0.9) << name << ", " << kind;
    }
  }
}

TEST_P(CategoryLabels, AreFoundWhereACloudShowsOneSideOnly) {
  // The side away from the viewer is there, but nothing is known of it.
  for (const std::string& name : category_.novel) {
    const LabelledMesh object = workshop::LoadObject(category_.name, name);
    const SurfaceSamples samples = SampleSurface(object.mesh_O, 3000, 2);
    std::vector<Eigen::Vector3d> seen;
    for (int i = 0; i < samples.size(); ++i) {
      if (samples.normals[i].y() < -0.1) seen.push_back(samples.points[i]);
    }
    const SeenSurface surface(seen, 0.008);
    const Outcome outcome = Segment(object, &surface);
    EXPECT_NE(outcome.verdict, SegmentationVerdict::kForeign) << name;
    EXPECT_GE(outcome.agreement, 0.9) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Data, CategoryLabels,
                         ::testing::Values("mug", "power_drill", "spray_bottle",
                                           "hammer"),
                         [](const auto& category) {
                           return std::string(category.param);
                         });

}  // namespace
}  // namespace graspdb
