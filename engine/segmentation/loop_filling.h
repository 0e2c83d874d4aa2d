#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace graspdb {

/** Triangulates a closed loop of points in space, planar or not, without new
 points: the triangulation of least area, with short chords preferred so that
 slivers are avoided (dynamic programming, Barequet and Sharir 1995; O(n³)).
 The triangles run through the loop's edges in the loop's own direction.
 @param is_forbidden  is_forbidden(i, j), i < j, tells of two points of the loop
   that must not be joined by a chord.
 @returns indices into the loop; nothing when every triangulation needs a
   forbidden chord.
 @pre At least three points. */
std::optional<std::vector<Eigen::Vector3i>> FillLoop(
    const std::vector<Eigen::Vector3d>& loop,
    const std::function<bool(int, int)>& is_forbidden);

}  // namespace graspdb
