#pragma once

#include <vector>

#include "engine/geometry/triangle_mesh.h"
#include "engine/parameters/transfer_parameters.h"
#include "engine/segmentation/face_graph.h"

namespace graspdb {

/** The shape diameter function (Shapira et al. 2008): per face the robust mean
 length, m, of 25 rays into the solid within 60° of the inward normal; 0 where
 no ray meets the far side. @pre The mesh is closed. */
std::vector<double> CalcShapeDiameters(const TriangleMesh& mesh);

/** How badly each of `clusters` levels of thickness, thin to thick, fits each
 face: costs[cluster][face], the negative logarithm of the cluster's share in a
 mixture of normal distributions over log-scaled shape diameters (Shapira et al.
 2008, Sec. 4), at least 0. @pre clusters >= 1; one diameter per face. */
std::vector<std::vector<double>> CalcThicknessCosts(
    const TriangleMesh& mesh, const std::vector<double>& diameters,
    int clusters);

/** Cuts a closed mesh where its thickness changes: a graph cut over
 CalcThicknessCosts(), with borders along valleys preferred. Connected pieces of
 one level are numbered from 0. Deterministic.
 @param links  Those of the mesh.
 @param radius  The mesh's rms radius, m. @paper{Sec. VI-B} */
std::vector<int> SegmentByShapeDiameter(
    const TriangleMesh& mesh, const std::vector<FaceLink>& links, double radius,
    const SegmentationParameters& parameters);

}  // namespace graspdb
