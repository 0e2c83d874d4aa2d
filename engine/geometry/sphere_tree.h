#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/points4.h"
#include "engine/geometry/triangle_mesh.h"
#include "engine/math/rigid_transform.h"

namespace graspdb {

/** Which least distances matter, m; `enough` is at most `most`. */
struct DistanceRange {
  double enough{-1e300};  ///< Once one below this is known, any such is told.
  double most{1e300};     ///< If none is below this, this is told.
};

/** A hierarchy of balls that covers a surface, with probe points spread over
 it. With a distance function of the other body, which must have Lipschitz
 constant one, it bounds the gap between two bodies from below without missing
 anything in between, and estimates it from the probes. A distance function
 takes Points4 in this surface's frame L and returns Floats4, m. */
class SphereTree {
 public:
  /** @param spacing  Of the probes, roughly, m; every corner of the mesh is or
     is near to one.
   @pre The mesh has a face; spacing > 0. */
  SphereTree(const TriangleMesh& mesh_L, double spacing);

  /** Points of the surface, grouped so that neighbours are close, m. */
  const std::vector<Eigen::Vector3d>& probes() const { return probes_; }

  /** The ball around everything. */
  const Eigen::Vector3d& center() const { return group_balls_[0].p; }
  double radius() const { return group_balls_[0].radius; }

  /** A lower bound of the least distance of the surface, as told by
   `distance(points)`, tight to half of it or to twice the smallest balls'
   radius, whichever is more; within the range. */
  template <class DistanceFunction>
  double CalcLowerBound(const DistanceFunction& distance,
                        const DistanceRange& range = {}) const {
    return Minimise(distance, range, [](int, double bound, double& best) {
      best = std::min(best, bound);
    });
  }

  /** The least distance of the surface, estimated by its probes: too large by
   what the surface bulges between them, and too small by half far away; within
   the range. */
  template <class DistanceFunction>
  double EstimateMinimum(const DistanceFunction& distance,
                         const DistanceRange& range = {}) const {
    return Minimise(distance, range, [&](int leaf, double, double& best) {
      const Floats4 d = distance(leaves_[static_cast<size_t>(leaf)].probes);
      best = std::min(
          {best, double{d[0]}, double{d[1]}, double{d[2]}, double{d[3]}});
    });
  }

  /** A lower bound of the gap between this surface A and another one, B, within
   the range. */
  double CalcGapBound(const SphereTree& B, const RigidTransform& X_AB,
                      const DistanceRange& range = {}) const;

  /** Calls visit(p_L, distance) for each probe no farther than `limit`, in
   order. @returns a lower bound of how far all others are. */
  template <class DistanceFunction, class Visitor>
  double VisitNear(const DistanceFunction& distance, double limit,
                   const Visitor& visit) const {
    double others = 1e300;
    int stack[kStackSize];
    int size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const int top = stack[--size];
      if (IsLeaf(top)) {
        const Leaf& leaf = leaves_[static_cast<size_t>(~top)];
        const Floats4 d = distance(leaf.probes);
        for (int lane = 0; lane < leaf.count; ++lane) {
          if (d[lane] <= limit) {
            visit(probes_[static_cast<size_t>(leaf.first + lane)],
                  double{d[lane]});
          } else {
            others = std::min(others, double{d[lane]});
          }
        }
        continue;
      }
      const Group& group = groups_[static_cast<size_t>(top)];
      const Floats4 bounds = distance(group.centers) - group.radii;
      // The last child goes first onto the stack: probes come in order.
      for (int lane = 3; lane >= 0; --lane) {
        if (bounds[lane] <= limit) {
          stack[size++] = group.children[lane];
        } else {
          others = std::min(others, double{bounds[lane]});
        }
      }
    }
    return others;
  }

 private:
  // Enough for three siblings on each of twenty levels.
  static constexpr int kStackSize = 64;

  // Up to four balls; absent ones are infinitely far away.
  struct Group {
    Points4 centers;
    Floats4 radii{-1e30F, -1e30F, -1e30F, -1e30F};
    std::array<int, 4> children{};  // Groups, or ~leaf.
  };

  // Up to four probes; absent ones repeat the first.
  struct Leaf {
    Points4 probes;
    int first{0};  // In probes_.
    int count{0};
  };

  // While building, a probe: all of the surface that it stands for lies within
  // `radius` of it.
  struct Ball {
    Eigen::Vector3d p{Eigen::Vector3d::Zero()};
    double radius{0.0};
  };

  static bool IsLeaf(int child) { return child < 0; }
  const Ball& BallOf(int child) const {
    return IsLeaf(child) ? leaf_balls_[static_cast<size_t>(~child)]
                         : group_balls_[static_cast<size_t>(child)];
  }

  // Branch and bound; `lower(leaf, bound, best)` lowers the best by a leaf
  // whose ball is no nearer than the bound.
  template <class DistanceFunction, class LowerByLeaf>
  double Minimise(const DistanceFunction& distance, const DistanceRange& range,
                  const LowerByLeaf& lower) const {
    struct Entry {
      int child;
      double bound;
    };
    double best = range.most;
    Entry stack[kStackSize];
    int size = 0;
    stack[size++] = {0, -1e300};
    while (size > 0) {
      const Entry top = stack[--size];
      if (top.bound >= best) continue;
      if (IsLeaf(top.child)) {
        lower(~top.child, top.bound, best);
        if (best < range.enough) return best;
        continue;
      }
      const Group& group = groups_[static_cast<size_t>(top.child)];
      const Floats4 d = distance(group.centers);
      const Floats4 bounds = d - group.radii;
      const int first = size;
      for (int lane = 0; lane < 4; ++lane) {
        const double bound = bounds[lane];
        if (!(bound < best)) continue;  // Absent, too, or no number.
        // Far enough for its size: looking closer would gain little.
        if (2.0F * group.radii[lane] <= d[lane]) {
          best = bound;
          continue;
        }
        // The nearest child comes last, so that it rules out more of the rest.
        int at = size++;
        for (; at > first && stack[at - 1].bound < bound; --at) {
          stack[at] = stack[at - 1];
        }
        stack[at] = {group.children[static_cast<size_t>(lane)], bound};
      }
      if (best < range.enough) return best;
    }
    return best;
  }

  static std::vector<Ball> SpreadProbes(const TriangleMesh& mesh_L,
                                        double spacing);
  static Ball Enclose(const std::vector<Ball>& balls, int first, int count);
  static int Split(std::vector<Ball>& balls, int first, int count);
  int Build(std::vector<Ball>& balls, int first, int count);

  std::vector<Eigen::Vector3d> probes_;
  std::vector<Group> groups_;
  std::vector<Leaf> leaves_;
  std::vector<Ball> group_balls_;
  std::vector<Ball> leaf_balls_;
};

}  // namespace graspdb
