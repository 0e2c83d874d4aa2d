#pragma once

#include <vector>

#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** Two faces that share an edge. */
struct FaceLink {
  int face_a{0};
  int face_b{0};
  double length{0.0};  ///< Of the shared edge, m.
  double angle{0.0};   ///< Between the normals, rad; negative: concave.
};

/** Every pair of neighbouring faces, in the order of face_a, then of its edges.
 @pre No edge has more than two faces. */
std::vector<FaceLink> CalcFaceLinks(const TriangleMesh& mesh);

/** Connected groups of faces of one label: a component number per face, counted
 from 0 in the order of each component's first face. */
std::vector<int> CalcComponents(const std::vector<int>& face_labels,
                                const std::vector<FaceLink>& links);

/** Relabels every component smaller than min_share of its label's area to the
 label that it shares the longest border with.
 @param min_share  In [0, 1). */
std::vector<int> MergeIslands(const TriangleMesh& mesh,
                              const std::vector<FaceLink>& links,
                              std::vector<int> face_labels, double min_share);

}  // namespace graspdb
