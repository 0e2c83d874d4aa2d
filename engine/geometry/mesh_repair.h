#pragma once

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

/** Makes one closed solid of a triangle soup: weld, drop degenerate and
 duplicate faces, orient, stitch, fill holes, unite or wrap several shells
 (alpha wrap), orient outward.
 A mesh that needs nothing keeps its vertices and faces in their order, exactly.
 @retval kUnusableInput when no solid can be made (zero area, all points
   coplanar, …), with what is wrong in words. */
Result<RepairedMesh> RepairMesh(const TriangleMesh& soup);

}  // namespace graspdb
