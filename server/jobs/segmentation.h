#pragma once

#include <string>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "server/records.h"
#include "server/store/store.h"

namespace graspdb {

/** An object's labels, parts and how it came by them: what the store keeps. */
struct SegmentedObject {
  std::string category;
  StoredSegmentation record;
  ObjectMeshes meshes;            ///< With labels.
  std::vector<StoredPart> parts;  ///< Empty when none could be cut.
  std::vector<Part> solids;       ///< In parallel to parts.
};

/** What the examples of a category offer for segmenting others. */
struct ExampleSet {
  std::vector<std::string> ids;
  std::vector<LabelledMesh> meshes;  ///< Work meshes, in parallel to ids.
};

/** All labelled examples of a category but the one with the id `except`. */
Result<ExampleSet> LoadExamples(const Store& store, const std::string& category,
                                const std::string& except);

/** The place of each label among the category's parts.
 @retval kInvalidArgument naming the known ones. */
Result<std::vector<int>> IndexLabels(const StoredCategory& category,
                                     const std::vector<std::string>& labels);

/** @retval kInvalidArgument unless there is one label per face. */
Result<void> CheckFaceLabels(const std::vector<std::string>& labels,
                             int num_faces);

/** Takes over one label per face of the canonical mesh.
 @retval kInvalidArgument for unknown labels or a wrong number of them. */
Result<SegmentedObject> SegmentByLabels(const StoredCategory& category,
                                        const ObjectMeshes& meshes,
                                        const std::vector<std::string>& labels,
                                        const ExecutionContext& context);

/** Gives the object the labels that its meshes already carry.
 @param record  How it came by them. */
Result<SegmentedObject> CutLabelledObject(const StoredCategory& category,
                                          const StoredSegmentation& record,
                                          const ObjectMeshes& meshes);

/** Segments by the category's examples.
 @retval kConflict when it has none. */
Result<SegmentedObject> SegmentByExamples(
    const Store& store, const StoredCategory& category,
    const SegmentationParameters& parameters, const ObjectMeshes& meshes,
    const std::string& except, uint64_t seed, ExecutionContext& context);

/** The same for the category whose examples are the most similar.
 @retval kNotInCategory when none is similar.
 @retval kConflict when there are no examples at all. */
Result<SegmentedObject> SegmentByAnyCategory(const Store& store,
                                             const ObjectMeshes& meshes,
                                             const std::string& except,
                                             uint64_t seed,
                                             ExecutionContext& context);

}  // namespace graspdb
