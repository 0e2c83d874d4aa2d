#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/triangle_mesh.h"
#include "engine/math/rigid_transform.h"

namespace graspdb {

/** A hierarchy of balls that covers a surface, with probe points spread over
 it. With a distance function of the other body, which must have Lipschitz
 constant one, it bounds the gap between two bodies from below without missing
 anything in between, and estimates it from the probes. */
class SphereTree {
 public:
  /** @param spacing  Of the probes, roughly, m; every corner of the mesh is or
     is near to one.
   @pre The mesh has a face; spacing > 0. */
  SphereTree(const TriangleMesh& mesh_L, double spacing);

  /** Points of the surface, grouped so that neighbours are close, m. */
  const std::vector<Eigen::Vector3d>& probes() const { return probes_; }

  /** The ball around everything. */
  const Eigen::Vector3d& center() const { return nodes_[0].center; }
  double radius() const { return nodes_[0].radius; }

  /** A lower bound of the least distance of the surface, as told by
   `distance(p_L)`, tight to half of it or to twice the smallest balls'
   radius, whichever is more. Once it is known to be below `enough`, any value
   below that is returned. */
  template <class DistanceFunction>
  double CalcLowerBound(const DistanceFunction& distance, double enough) const {
    return Minimise(distance, enough, [&](const Node& node, double& best) {
      const double bound = distance(node.center) - node.radius;
      best = bound < best ? bound : best;
    });
  }

  /** The least distance of the surface, estimated by its probes: too large by
   what the surface bulges between them, and too small by half far away. Once
   it is known to be below `enough`, any value below that is returned. */
  template <class DistanceFunction>
  double EstimateMinimum(const DistanceFunction& distance,
                         double enough) const {
    return Minimise(distance, enough, [&](const Node& node, double& best) {
      for (int i = 0; i < node.num_probes; ++i) {
        const double d = distance(probes_[node.first + i]);
        best = d < best ? d : best;
      }
    });
  }

  /** A lower bound of the gap between this surface A and another one, B. Once
   it is known to be below `enough`, any value below that is returned. */
  double CalcGapBound(const SphereTree& B, const RigidTransform& X_AB,
                      double enough) const;

  /** Calls visit(p_L, distance) for each probe no farther than `limit`, in
   order. @returns a lower bound of how far all others are. */
  template <class DistanceFunction, class Visitor>
  double VisitNear(const DistanceFunction& distance, double limit,
                   const Visitor& visit) const {
    double others = 1e300;
    int stack[64];
    int size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const Node& node = nodes_[stack[--size]];
      const double bound = distance(node.center) - node.radius;
      if (bound > limit) {
        others = std::min(others, bound);
      } else if (node.num_probes > 0) {
        for (int i = 0; i < node.num_probes; ++i) {
          const Eigen::Vector3d& p_L = probes_[node.first + i];
          const double d = distance(p_L);
          if (d <= limit) {
            visit(p_L, d);
          } else {
            others = std::min(others, d);
          }
        }
      } else {
        // The second child goes first onto the stack: probes come in order.
        stack[size++] = node.first + 1;
        stack[size++] = node.first;
      }
    }
    return others;
  }

 private:
  struct Node {
    Eigen::Vector3d center;
    double radius{0.0};
    int first{0};       // First probe of a leaf, or first of two children.
    int num_probes{0};  // 0 for an inner node.
  };

  // Branch and bound; `lower(leaf, best)` lowers the best by a leaf.
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
      if (node.radius <= 0.5 * d) {
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
      if (node.num_probes > 0) {
        lower(node, best);
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

  // A probe while building: all of the surface that it stands for lies within
  // `radius` of it.
  struct Ball {
    Eigen::Vector3d p;
    double radius{0.0};
  };
  static std::vector<Ball> SpreadProbes(const TriangleMesh& mesh_L,
                                        double spacing);
  void Build(int node, int first, int count, std::vector<Ball>& balls);

  std::vector<Eigen::Vector3d> probes_;
  std::vector<Node> nodes_;
};

}  // namespace graspdb
