#pragma once

#include <string>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "engine/math/rigid_transform.h"
#include "engine/parameters.h"
#include "engine/segmentation/part.h"

namespace graspdb {

/** How sure the segmentation is that the parts are the category's. */
enum class SegmentationVerdict {
  kMatched,  ///< The residual, area and topology tests all pass.
  kUnsure,   ///< Labels were carried over, but some test fails narrowly.
  kForeign,  ///< The object does not look like any example.
};

/** An object cut into the category's parts. */
struct SegmentationResult {
  std::vector<int> face_labels;  ///< Per face of the object.
  std::vector<Part> parts;       ///< One per label found, in label order.
  SegmentationVerdict verdict{SegmentationVerdict::kForeign};
  int example{0};           ///< The example with the lowest residual.
  RigidTransform X_NE;      ///< Example E in the object's frame N …
  double scale{1.0};        ///< … after E is scaled by this about its origin.
  double residual{0.0};     ///< e of algorithms.md, squared rms radii.
  double similarity{0.0};   ///< 1 at residual 0, 0 at twice the limit.
  std::vector<std::string> warnings;  ///< In words, for the user.
};

/** Carries the labels of the best-aligned example over to mesh_N and cuts it
 into capped, closed parts (or, with parameters.by_shape_diameter, cuts by shape
 diameter and matches the parts to the example's).
 Deterministic for a seed. @pre examples is not empty; mesh_N is closed.
 @retval kCancelled when the context says so. */
Result<SegmentationResult> SegmentObject(
    const TriangleMesh& mesh_N, const PartVocabulary& vocabulary,
    const std::vector<LabelledMesh>& examples,
    const SegmentationParameters& parameters, uint64_t seed,
    ExecutionContext& context);

/** Cuts a labelled object into parts: each label's faces with the cut closed by
 cap faces. Labels without faces yield no part.
 @pre One label per face, each an index into the vocabulary.
 @retval kUnusableInput when a part cannot be closed. */
Result<std::vector<Part>> CutIntoParts(const LabelledMesh& object,
                                       const PartVocabulary& vocabulary);

}  // namespace graspdb
