#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** A small flat triangle of a surface: all of it lies within radius of p_L. */
struct SurfacePatch {
  std::array<Eigen::Vector3d, 3> corners_L;  ///< m.
  Eigen::Vector3d p_L;                       ///< Its centroid, m.
  double radius{0.0};                        ///< m.
};

SurfacePatch MakeSurfacePatch(const std::array<Eigen::Vector3d, 3>& corners_L);

/** Both halves of a patch, cut through the middle of its longest edge. */
std::array<SurfacePatch, 2> SplitPatch(const SurfacePatch& patch);

/** A hierarchy of spheres that covers a surface. With a distance function of
 the other body, which must have Lipschitz constant one, it bounds the gap
 between two bodies from below without missing anything in between. */
class SphereTree {
 public:
  /** Cuts the surface into patches of at most max_radius, m.
   @pre The mesh has a face; max_radius > 0. */
  SphereTree(const TriangleMesh& mesh_L, double max_radius);

  /** Patches, grouped so that neighbours are close to each other. */
  const std::vector<SurfacePatch>& patches() const { return patches_; }

  /** The sphere around everything. */
  const Eigen::Vector3d& center() const { return nodes_[0].center; }
  double radius() const { return nodes_[0].radius; }

  /** A lower bound of the least distance of the surface, as told by
   `distance(p_L)`, tight to a quarter of it or to twice the patches' radius,
   whichever is more. Once it is known to be below `enough`, any value below
   that is returned. */
  template <class DistanceFunction>
  double CalcLowerBound(const DistanceFunction& distance, double enough) const {
    return Minimise(distance, enough,
                    [&](const SurfacePatch& patch, double& best) {
                      const double bound = distance(patch.p_L) - patch.radius;
                      best = bound < best ? bound : best;
                    });
  }

  /** The least distance of the surface, estimated: patches that matter are
   split until their radius is at most `finest` and then stand for their
   centres, so that it may be too large by `finest`, less on smooth surfaces,
   and too small by a quarter. */
  template <class DistanceFunction>
  double EstimateMinimum(const DistanceFunction& distance,
                         double finest) const {
    return Minimise(distance, -1e300,
                    [&](const SurfacePatch& patch, double& best) {
                      LowerByPatch(distance, patch, finest, best);
                    });
  }

  /** Calls visit(patch) for each patch of which some point may be nearer than
   `limit`. */
  template <class DistanceFunction, class Visitor>
  void VisitNear(const DistanceFunction& distance, double limit,
                 const Visitor& visit) const {
    int stack[64];
    int size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const Node& node = nodes_[stack[--size]];
      if (distance(node.center) - node.radius > limit) continue;
      if (node.num_patches > 0) {
        for (int i = 0; i < node.num_patches; ++i) {
          const SurfacePatch& patch = patches_[node.first + i];
          if (distance(patch.p_L) - patch.radius <= limit) visit(patch);
        }
      } else {
        // The second child goes first onto the stack: patches come in order.
        stack[size++] = node.first + 1;
        stack[size++] = node.first;
      }
    }
  }

 private:
  struct Node {
    Eigen::Vector3d center;
    double radius{0.0};
    int first{0};        // First patch of a leaf, or first of two children.
    int num_patches{0};  // 0 for an inner node.
  };

  // Branch and bound; `lower(patch, best)` lowers the best by a patch.
  template <class DistanceFunction, class LowerByLeaf>
  double Minimise(const DistanceFunction& distance, double enough,
                  const LowerByLeaf& lower) const {
    struct Entry {
      int node;
      double bound;
    };
    double best = 1e300;
    Entry stack[64];
    int size = 0;
    const auto enter = [&](int i) {
      const Node& node = nodes_[i];
      const double d = distance(node.center);
      const double bound = d - node.radius;
      // Far enough for its size: looking closer would gain little.
      if (node.radius <= 0.25 * d) {
        best = bound < best ? bound : best;
        return Entry{i, 1e300};
      }
      return Entry{i, bound};
    };
    stack[size++] = enter(0);
    while (size > 0) {
      const Entry top = stack[--size];
      if (top.bound >= best) continue;
      const Node& node = nodes_[top.node];
      if (node.num_patches > 0) {
        for (int i = 0; i < node.num_patches; ++i) {
          lower(patches_[node.first + i], best);
        }
        if (best < enough) return best;
        continue;
      }
      // The nearer child first, so that it rules out more of the other.
      const Entry a = enter(node.first);
      const Entry b = enter(node.first + 1);
      stack[size++] = a.bound < b.bound ? b : a;
      stack[size++] = a.bound < b.bound ? a : b;
    }
    return best;
  }

  template <class DistanceFunction>
  static void LowerByPatch(const DistanceFunction& distance,
                           const SurfacePatch& patch, double finest,
                           double& best) {
    const double d = distance(patch.p_L);
    const double bound = d - patch.radius;
    if (bound >= best) return;
    if (patch.radius <= finest || patch.radius <= 0.25 * d) {
      const double value = patch.radius <= finest ? d : bound;
      best = value < best ? value : best;
      return;
    }
    for (const SurfacePatch& half : SplitPatch(patch)) {
      LowerByPatch(distance, half, finest, best);
    }
  }

  void Build(int node, int first, int count);

  std::vector<SurfacePatch> patches_;
  std::vector<Node> nodes_;
};

}  // namespace graspdb
