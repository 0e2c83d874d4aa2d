#pragma once

#include <string>
#include <utility>
#include <vector>

#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** The part names of a category and which parts touch. */
struct PartVocabulary {
  std::vector<std::string> labels;             ///< e.g. {"body", "handle"}.
  std::vector<std::pair<int, int>> adjacency;  ///< Pairs of label indices.

  bool operator==(const PartVocabulary&) const = default;
};

/** A solid cut from an object O at the part's boundary. It stays in frame O, so
 that assembly needs no transform. */
struct Part {
  int label{0};          ///< Index into PartVocabulary::labels.
  TriangleMesh solid_O;  ///< Closed: surface faces first, then cap faces.
  /** How many of solid_O's faces are object surface; the rest close the cut
   and must not be touched. */
  int num_surface_faces{0};
  std::vector<int> object_faces;  ///< The object's face of each surface face.
  double confidence{1.0};         ///< 0..1, how sure the label is.
};

/** An object with one label per face. */
struct LabelledMesh {
  TriangleMesh mesh_O;
  std::vector<int> face_labels;  ///< Index into the vocabulary, per face.

  bool operator==(const LabelledMesh&) const = default;
};

}  // namespace graspdb
