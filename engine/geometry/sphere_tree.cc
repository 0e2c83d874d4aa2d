#include "engine/geometry/sphere_tree.h"

#include <algorithm>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

constexpr int kPatchesPerLeaf = 6;

// Halves the patch until it is small enough.
void AddPatches(const SurfacePatch& patch, double max_radius,
                std::vector<SurfacePatch>& patches) {
  if (patch.radius <= max_radius) {
    patches.push_back(patch);
    return;
  }
  for (const SurfacePatch& half : SplitPatch(patch)) {
    AddPatches(half, max_radius, patches);
  }
}

}  // namespace

SurfacePatch MakeSurfacePatch(const std::array<Eigen::Vector3d, 3>& corners_L) {
  SurfacePatch patch;
  patch.corners_L = corners_L;
  patch.p_L = (corners_L[0] + corners_L[1] + corners_L[2]) / 3.0;
  for (const Eigen::Vector3d& p : corners_L) {
    patch.radius = std::max(patch.radius, (p - patch.p_L).norm());
  }
  return patch;
}

std::array<SurfacePatch, 2> SplitPatch(const SurfacePatch& patch) {
  const std::array<Eigen::Vector3d, 3>& p = patch.corners_L;
  const auto squared_edge = [&p](int k) {
    return (p[(k + 1) % 3] - p[k]).squaredNorm();
  };
  int k = 0;
  for (int i = 1; i < 3; ++i) {
    if (squared_edge(i) > squared_edge(k)) k = i;
  }
  const Eigen::Vector3d middle = 0.5 * (p[k] + p[(k + 1) % 3]);
  return {MakeSurfacePatch({p[k], middle, p[(k + 2) % 3]}),
          MakeSurfacePatch({middle, p[(k + 1) % 3], p[(k + 2) % 3]})};
}

SphereTree::SphereTree(const TriangleMesh& mesh_L, double max_radius) {
  GRASPDB_EXPECTS(mesh_L.num_triangles() > 0 && max_radius > 0.0);
  for (int f = 0; f < mesh_L.num_triangles(); ++f) {
    AddPatches(MakeSurfacePatch({mesh_L.corner(f, 0), mesh_L.corner(f, 1),
                                 mesh_L.corner(f, 2)}),
               max_radius, patches_);
  }
  nodes_.emplace_back();
  Build(0, 0, static_cast<int>(patches_.size()));
}

void SphereTree::Build(int node, int first, int count) {
  const auto begin = patches_.begin() + first;
  const auto end = begin + count;
  Eigen::Vector3d low = begin->p_L, high = begin->p_L;
  for (auto it = begin; it != end; ++it) {
    low = low.cwiseMin(it->p_L);
    high = high.cwiseMax(it->p_L);
  }
  Node result;
  result.center = 0.5 * (low + high);
  for (auto it = begin; it != end; ++it) {
    result.radius =
        std::max(result.radius, (it->p_L - result.center).norm() + it->radius);
  }
  if (count <= kPatchesPerLeaf) {
    result.first = first;
    result.num_patches = count;
    nodes_[node] = result;
    return;
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  std::stable_sort(begin, end,
                   [axis](const SurfacePatch& a, const SurfacePatch& b) {
                     return a.p_L[axis] < b.p_L[axis];
                   });
  result.first = static_cast<int>(nodes_.size());
  nodes_[node] = result;
  nodes_.emplace_back();
  nodes_.emplace_back();
  Build(result.first, first, count / 2);
  Build(result.first + 1, first + count / 2, count - count / 2);
}

}  // namespace graspdb
