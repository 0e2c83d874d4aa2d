#include "server/jobs/segmentation.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "engine/geometry/surface_index.h"
#include "engine/segmentation/part_cutting.h"

namespace graspdb {
namespace {

// Without a category named, less than this is no answer …
constexpr double kLeastSimilarity = 0.5;
// … and two that differ by less are told of both.
constexpr double kTooClose = 0.1;
constexpr size_t kMostNamed = 3;

// "mug 0.81, hammer 0.12"
std::string NameNearest(const std::vector<SegmentedObject>& nearest) {
  std::string names;
  for (size_t i = 0; i < std::min(nearest.size(), kMostNamed); ++i) {
    names += fmt::format("{}{} {:.2f}", i == 0 ? "" : ", ", nearest[i].category,
                         nearest[i].record.similarity);
  }
  return names;
}

// Per face of `to`, the label of the face of `from` nearest to its centroid.
Result<std::vector<int>> CarryLabels(const TriangleMesh& from,
                                     const std::vector<int>& labels,
                                     const TriangleMesh& to,
                                     const ExecutionContext& context) {
  if (from == to) return labels;
  const SurfaceIndex index(from);
  std::vector<int> carried;
  for (int f = 0; f < to.num_triangles(); ++f) {
    if (context.Cancelled()) {
      return Error{ErrorCode::kCancelled, "segmentation was cancelled"};
    }
    const auto closest = index.FindClosest(to.centroid(f));
    carried.push_back(labels[static_cast<size_t>(closest->face)]);
  }
  return carried;
}

// For each label the labels that share an edge with it.
std::map<int, std::set<int>> FindAdjacency(const TriangleMesh& mesh,
                                           const std::vector<int>& labels) {
  std::map<std::pair<int, int>, int> first_label;
  std::map<int, std::set<int>> adjacent;
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    const Eigen::Vector3i& t = mesh.triangles()[f];
    for (int k = 0; k < 3; ++k) {
      const std::pair<int, int> edge = std::minmax(t[k], t[(k + 1) % 3]);
      const int label = labels[static_cast<size_t>(f)];
      const int other = first_label.emplace(edge, label).first->second;
      if (other == label) continue;
      adjacent[label].insert(other);
      adjacent[other].insert(label);
    }
  }
  return adjacent;
}

// The rows of the parts whose solids were cut.
std::vector<StoredPart> DescribeParts(const StoredCategory& category,
                                      const ObjectMeshes& meshes,
                                      const std::vector<Part>& solids) {
  const auto label_of = [&](int index) {
    return category.parts[static_cast<size_t>(index)].label;
  };
  const auto adjacency =
      FindAdjacency(meshes.canonical, meshes.canonical_labels);
  std::vector<StoredPart> parts;
  for (const Part& solid : solids) {
    StoredPart part;
    part.label_index = solid.label;
    part.label = label_of(solid.label);
    part.confidence = solid.confidence;
    part.volume = CalcMassProperties(solid.solid_O).volume;
    for (int f = 0; f < solid.num_surface_faces; ++f) {
      part.area += solid.solid_O.area(f);
    }
    for (size_t f = 0; f < meshes.canonical_labels.size(); ++f) {
      if (meshes.canonical_labels[f] == solid.label) {
        part.faces.push_back(static_cast<int>(f));
      }
    }
    if (const auto found = adjacency.find(solid.label);
        found != adjacency.end()) {
      for (const int other : found->second) {
        part.adjacent.push_back(label_of(other));
      }
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

Result<SegmentedObject> MakeSegmentedObject(
    const StoredCategory& category, const ObjectMeshes& meshes,
    const ExampleSet& examples, const SegmentationParameters& parameters,
    SegmentationResult result, const ExecutionContext& context) {
  SegmentedObject object;
  object.category = category.name;
  StoredSegmentation& record = object.record;
  record.method = parameters.by_shape_diameter ? "shape_diameter" : "transfer";
  record.verdict = ToString(result.verdict);
  record.example_id = examples.ids[static_cast<size_t>(result.example)];
  record.X_NE = result.X_NE;
  record.scale = result.scale;
  record.residual = result.residual;
  record.similarity = result.similarity;
  record.warnings = std::move(result.warnings);
  object.meshes = meshes;
  object.meshes.work_labels = std::move(result.face_labels);
  GRASPDB_TRY(labels, CarryLabels(meshes.work, object.meshes.work_labels,
                                  meshes.canonical, context));
  object.meshes.canonical_labels = std::move(labels);
  object.parts = DescribeParts(category, object.meshes, result.parts);
  object.solids = std::move(result.parts);
  return object;
}

}  // namespace

Result<ExampleSet> LoadExamples(const Store& store, const std::string& category,
                                const std::string& except) {
  ExampleSet examples;
  PageRequest page{1000, ""};
  do {
    GRASPDB_TRY(objects,
                store.ListObjects({category, ObjectRole::kExample}, page));
    for (const StoredObject& object : objects.items) {
      if (object.id == except) continue;
      GRASPDB_TRY(meshes, store.ReadObjectMeshes(object.id));
      if (meshes.work_labels.empty()) continue;
      examples.ids.push_back(object.id);
      examples.meshes.push_back(
          {std::move(meshes.work), std::move(meshes.work_labels)});
    }
    page.cursor = objects.next_cursor;
  } while (!page.cursor.empty());
  return examples;
}

Result<void> CheckFaceLabels(const std::vector<std::string>& labels,
                             int num_faces) {
  if (std::ssize(labels) == num_faces) return {};
  return Error{
      ErrorCode::kInvalidArgument,
      fmt::format("There are {} face labels for {} faces.", labels.size(),
                  num_faces),
      "label the faces of GET /v1/objects/{id}/mesh; a mesh that had to be "
      "repaired has other faces than its file",
      "face_labels"};
}

Result<std::vector<int>> IndexLabels(const StoredCategory& category,
                                     const std::vector<std::string>& labels) {
  const std::map<std::string, int> indices = IndexParts(category.parts);
  std::vector<int> indexed;
  indexed.reserve(labels.size());
  for (const std::string& label : labels) {
    const auto found = indices.find(label);
    if (found == indices.end()) {
      std::string known;
      for (const CategoryPart& part : category.parts) {
        known += (known.empty() ? "" : ", ") + part.label;
      }
      return Error{
          ErrorCode::kInvalidArgument,
          "Category '" + category.name + "' has no part '" + label + "'.",
          "known: " + known, "face_labels"};
    }
    indexed.push_back(found->second);
  }
  return indexed;
}

Result<SegmentedObject> SegmentByLabels(const StoredCategory& category,
                                        const ObjectMeshes& meshes,
                                        const std::vector<std::string>& labels,
                                        const ExecutionContext& context) {
  GRASPDB_TRY_VOID(CheckFaceLabels(labels, meshes.canonical.num_triangles()));
  GRASPDB_TRY(indexed, IndexLabels(category, labels));
  ObjectMeshes labelled = meshes;
  labelled.canonical_labels = std::move(indexed);
  GRASPDB_TRY(carried,
              CarryLabels(labelled.canonical, labelled.canonical_labels,
                          labelled.work, context));
  labelled.work_labels = std::move(carried);
  StoredSegmentation record;
  record.method = "labels";
  record.verdict = ToString(SegmentationVerdict::kMatched);
  record.similarity = 1.0;
  return CutLabelledObject(category, record, labelled);
}

Result<SegmentedObject> CutLabelledObject(const StoredCategory& category,
                                          const StoredSegmentation& record,
                                          const ObjectMeshes& meshes) {
  SegmentedObject object;
  object.category = category.name;
  object.record = record;
  object.meshes = meshes;
  GRASPDB_TRY(solids, CutIntoParts({meshes.work, meshes.work_labels},
                                   MakeVocabulary(category)));
  object.parts = DescribeParts(category, meshes, solids);
  object.solids = std::move(solids);
  return object;
}

Result<SegmentedObject> SegmentByExamples(
    const Store& store, const StoredCategory& category,
    const SegmentationParameters& parameters, const ObjectMeshes& meshes,
    const std::string& except, uint64_t seed, ExecutionContext& context) {
  GRASPDB_TRY(examples, LoadExamples(store, category.name, except));
  if (examples.ids.empty()) {
    return Error{
        ErrorCode::kConflict,
        "Category '" + category.name + "' has no example to tell the parts by.",
        "POST /v1/categories/" + category.name +
            "/examples with a mesh and its face labels, or graspdb "
            "populate data",
        "category"};
  }
  std::optional<SeenSurface> seen;
  if (!meshes.cloud.empty() && meshes.cloud_report.one_sided) {
    seen.emplace(meshes.cloud, CalcSeenReach(meshes.cloud_report));
  }
  GRASPDB_TRY(result, SegmentObject(meshes.work, MakeVocabulary(category),
                                    examples.meshes, parameters, seed, context,
                                    seen ? &*seen : nullptr));
  return MakeSegmentedObject(category, meshes, examples, parameters,
                             std::move(result), context);
}

Result<SegmentedObject> SegmentByAnyCategory(const Store& store,
                                             const ObjectMeshes& meshes,
                                             const std::string& except,
                                             uint64_t seed,
                                             ExecutionContext& context) {
  std::vector<SegmentedObject> nearest;  // One per category that has examples.
  PageRequest page{1000, ""};
  do {
    GRASPDB_TRY(categories, store.ListCategories(page));
    for (const StoredCategory& category : categories.items) {
      auto found = SegmentByExamples(store, category, category.segmentation,
                                     meshes, except, seed, context);
      if (!found && found.error().code == ErrorCode::kCancelled) {
        return found.error();
      }
      if (found) nearest.push_back(*std::move(found));
    }
    page.cursor = categories.next_cursor;
  } while (!page.cursor.empty());
  if (nearest.empty()) {
    return Error{ErrorCode::kConflict,
                 "There is no example of any category to compare with.",
                 "graspdb populate data", "category"};
  }
  std::stable_sort(nearest.begin(), nearest.end(),
                   [](const SegmentedObject& a, const SegmentedObject& b) {
                     return a.record.similarity > b.record.similarity;
                   });
  SegmentedObject& best = nearest.front();
  if (best.record.similarity < kLeastSimilarity ||
      best.record.verdict == ToString(SegmentationVerdict::kForeign)) {
    return Error{ErrorCode::kNotInCategory,
                 "The object is like no example; the nearest are " +
                     NameNearest(nearest) + ".",
                 "name its category, or add an example like it", "category"};
  }
  if (nearest.size() > 1 &&
      nearest[1].record.similarity > best.record.similarity - kTooClose) {
    best.record.warnings.push_back(
        fmt::format("taken for a {}, but almost as much like a {}: {}",
                    best.category, nearest[1].category, NameNearest(nearest)));
  }
  return std::move(best);
}

}  // namespace graspdb
