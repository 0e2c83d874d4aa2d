#pragma once

#include <vector>

#include "engine/geometry/surface_samples.h"
#include "engine/parameters/transfer_parameters.h"
#include "engine/registration/sample_matching.h"
#include "engine/segmentation/face_graph.h"
#include "engine/segmentation/part.h"

namespace graspdb {

/** How badly each label fits each face of a novel object: costs[label][face],
 0 for the best label, at most parameters.unary_cap; dimensionless. A label
 without samples costs the cap everywhere.

 The cost is the mean 6-D squared distance from the face to the three nearest
 samples of the label, laid over the novel object by map_NE.
 @param samples_E  Samples of the example …
 @param sample_labels  … and their labels, in [0, num_labels).
 @param radius  The novel object's rms radius, m. */
std::vector<std::vector<double>> CalcLabelCosts(
    const TriangleMesh& mesh_N, const SurfaceSamples& samples_E,
    const std::vector<int>& sample_labels, int num_labels,
    const AffineMap& map_NE, double radius,
    const SegmentationParameters& parameters);

/** Picks one label per face: least area-weighted cost plus the length of the
 borders, which are cheap along valleys and dear over ridges; then merges
 islands. */
std::vector<int> CutByLabelCosts(const TriangleMesh& mesh_N,
                                 const std::vector<FaceLink>& links,
                                 const std::vector<std::vector<double>>& costs,
                                 double radius,
                                 const SegmentationParameters& parameters);

/** How sure each label is of its faces, one value in [0, 1] per label: the area
 mean of exp(-cost) over the sum of all labels' exp(-cost); 0 for a label
 without faces. */
std::vector<double> CalcLabelConfidence(
    const TriangleMesh& mesh_N, const std::vector<int>& face_labels,
    const std::vector<std::vector<double>>& costs);

}  // namespace graspdb
