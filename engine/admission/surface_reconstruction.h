#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/admission/cloud_report.h"
#include "engine/base/result.h"
#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** A closed surface through a cloud. */
struct ReconstructedSurface {
  TriangleMesh mesh_O;
  std::vector<Eigen::Vector3d> points_O;  ///< Those that it goes by.
  CloudReport report;
  std::vector<std::string> steps;  ///< One sentence each.
};

/** Fewer points tell too little of a shape. */
inline constexpr int kFewestPoints = 200;

/** Wraps a cloud: outliers dropped, at most 20,000 points kept, an alpha wrap
 (Portaneri et al. 2022) that bridges what random sampling leaves open, drawn
 back onto the points and smoothed. Neither normals nor viewpoints are needed.
 Where the points make one sheet, seen from one side, the wrap bridges more and
 more until it encloses something: the rest of the surface is made up.
 @param points_O  All finite, m.
 @retval kUnusableInput for fewer than kFewestPoints points, points in a plane,
   or when nothing closed comes out. */
Result<ReconstructedSurface> ReconstructSurface(
    const std::vector<Eigen::Vector3d>& points_O);

}  // namespace graspdb
