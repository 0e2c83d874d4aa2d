#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/segmentation/part.h"

namespace graspdb {

/** Cuts a labelled object into parts: each label's faces with the cut closed by
 cap faces, one cap per border loop. Labels without faces yield no part; the
 parts come in label order with confidence 1.
 @pre object.mesh_O is closed; one label per face, each an index into the
   vocabulary.
 @retval kUnusableInput when a part cannot be closed to a solid of positive
   volume. */
Result<std::vector<Part>> CutIntoParts(const LabelledMesh& object,
                                       const PartVocabulary& vocabulary);

}  // namespace graspdb
