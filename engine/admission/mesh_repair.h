#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/admission/surface_wrap.h"
#include "engine/base/result.h"
#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** One closed, outward-oriented solid and what it took to get there. */
struct RepairedMesh {
  TriangleMesh mesh;
  /** One sentence per step, in order: "welded 12 vertices", … ; empty when the
   input was already a closed, outward-oriented solid. */
  std::vector<std::string> repairs;
};

/** Makes one closed solid of a triangle soup (metres): weld, drop degenerate
 and duplicate faces, split edges at T-junctions, orient, stitch, fill holes,
 cut self-intersections out, unite overlapping shells, drop loose fragments. If
 that is not one solid, the whole is wrapped as a last resort (WrapSurface()).
 Every hole is closed, so a cup without thickness becomes full; the volume is
 that of everything the shells enclose, cavities included. A mesh that needs
 nothing keeps its vertices and faces in their order, exactly. The result is
 closed, outward, connected and does not cross itself.
 @param most_wrap_points  At least 1,000.
 @retval kUnusableInput when no solid can be made: no faces, coordinates that
   are not finite, zero area, all points in one plane (thinner than 1/10,000 of
   the diagonal), no volume enclosed, several solids apart from each other. */
Result<RepairedMesh> RepairMesh(const TriangleMesh& soup,
                                std::size_t most_wrap_points = kMostWrapPoints);

}  // namespace graspdb
