#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "engine/geometry/seen_surface.h"
#include "engine/math/rigid_transform.h"
#include "engine/parameters/transfer_parameters.h"
#include "engine/segmentation/part.h"
#include "engine/segmentation/part_cutting.h"

namespace graspdb {

/** How sure the segmentation is that the parts are the category's. */
enum class SegmentationVerdict {
  kMatched,  ///< The residual, area, topology and confidence tests all pass.
  kUnsure,   ///< The residual passes; another test fails, but not by far.
  kForeign,  ///< The object does not look like any example.
};

/** An object cut into the category's parts. */
struct SegmentationResult {
  std::vector<int> face_labels;  ///< Per face of the object.
  /** One per label found, in label order; none when a foreign object's cannot
   be closed. */
  std::vector<Part> parts;
  SegmentationVerdict verdict{SegmentationVerdict::kForeign};
  int example{0};          ///< The most similar one.
  RigidTransform X_NE;     ///< Example E in the object's frame N …
  double scale{1.0};       ///< … after E is scaled by this about its origin.
  double residual{0.0};    ///< e of algorithms.md, squared rms radii.
  double similarity{0.0};  ///< CalcSimilarity(), with half_similarity.
  std::vector<std::string> warnings;  ///< In words, for the user.
};

/** Carries the labels of the best-aligned example over to mesh_N and cuts it
 into capped, closed parts (or, with parameters.by_shape_diameter, cuts by shape
 diameter and gives each segment the example's label that lies there).
 Deterministic for a seed; independent of the object's pose and unit.
 @param seen_N  Not null when a point cloud shows one side of the object only:
   the example is laid over what it shows, and areas tell nothing.
 @pre examples is not empty, each has one label per face, an index into the
   vocabulary; mesh_N is closed.
 @retval kCancelled when the context says so.
 @retval kUnusableInput when a part cannot be closed. */
Result<SegmentationResult> SegmentObject(
    const TriangleMesh& mesh_N, const PartVocabulary& vocabulary,
    const std::vector<LabelledMesh>& examples,
    const SegmentationParameters& parameters, uint64_t seed,
    ExecutionContext& context, const SeenSurface* seen_N = nullptr);

}  // namespace graspdb
