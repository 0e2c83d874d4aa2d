#pragma once

#include <cstddef>
#include <string>
#include <vector>

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

/** A wrap of more points is begun anew, three times as coarse. An object of
 thin walls takes up to 12,400; a few spikes that cross each other in a box of
 their own size would take 35,000, and 20 s. */
inline constexpr std::size_t kMostWrapPoints = 13'000;

/** Makes one closed solid of a triangle soup (metres): weld, drop degenerate
 and duplicate faces, split edges at T-junctions, orient, stitch, fill holes,
 cut self-intersections out, unite overlapping shells, drop loose fragments. If
 that is not one solid, the whole is wrapped as a last resort (alpha wrap:
 nothing narrower than 1/75 of the diagonal is entered, and the surface lies
 within about 1/1000 of it; three times as much where that would take more than
 most_wrap_points). Every hole is closed, so a cup without thickness
 becomes full; the volume is that of everything the shells enclose, cavities
 included. A mesh that needs nothing keeps its vertices and faces in their
 order, exactly. The result is closed, outward, connected and does not cross
 itself.
 @param most_wrap_points  At least 1,000: the coarsest wrap takes some, too.
 @retval kUnusableInput when no solid can be made: no faces, coordinates that
   are not finite, zero area, all points in one plane (thinner than 1/10,000 of
   the diagonal), no volume enclosed, several solids apart from each other. */
Result<RepairedMesh> RepairMesh(const TriangleMesh& soup,
                                std::size_t most_wrap_points = kMostWrapPoints);

}  // namespace graspdb
