#include "engine/geometry/sphere_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "engine/base/contract.h"
#include "engine/geometry/surface_patch.h"

namespace graspdb {
namespace {

constexpr int kLanes = 4;
// What rounding to single precision moves a point by, a share of how far it is
// from the origin.
constexpr double kRounding = 2e-7;

// The radius of a ball around the rounded centre.
float CalcRoundedRadius(const Eigen::Vector3d& center, double radius) {
  return static_cast<float>(radius + kRounding * (center.norm() + radius));
}

}  // namespace

SphereTree::SphereTree(const TriangleMesh& mesh_L, double spacing) {
  GRASPDB_EXPECTS(mesh_L.num_triangles() > 0 && spacing > 0.0);
  std::vector<Ball> balls = SpreadProbes(mesh_L, spacing);
  groups_.emplace_back();
  group_balls_.emplace_back();
  const auto count = static_cast<int>(balls.size());
  if (Build(balls, 0, count) < 0) {
    // A lone leaf: the root has no other child.
    Group& root = groups_[0];
    root.centers.Set(0, leaf_balls_[0].p);
    root.radii[0] = CalcRoundedRadius(leaf_balls_[0].p, leaf_balls_[0].radius);
    root.children[0] = ~0;
    group_balls_[0] = leaf_balls_[0];
  }
  for (const Ball& ball : balls) probes_.push_back(ball.p);
}

double SphereTree::CalcGapBound(const SphereTree& B, const RigidTransform& X_AB,
                                const DistanceRange& range) const {
  struct Pair {
    int a, b;
    double bound;
  };
  double best = range.most;
  Pair stack[2 * kStackSize];  // Siblings on the levels of both trees.
  int size = 0;
  const auto enter = [&](int a, int b) {
    const Ball& ball_A = BallOf(a);
    const Ball& ball_B = B.BallOf(b);
    const double apart = (ball_A.p - X_AB * ball_B.p).norm();
    const double radii = ball_A.radius + ball_B.radius;
    // Far enough for their size: looking closer would gain little.
    if ((IsLeaf(a) && IsLeaf(b)) || radii <= 0.5 * apart) {
      best = std::min(best, apart - radii);
    } else if (apart - radii < best) {
      stack[size++] = {a, b, apart - radii};
    }
  };
  enter(0, 0);
  while (size > 0 && best >= range.enough) {
    const Pair top = stack[--size];
    if (top.bound >= best) continue;
    const bool split_A =
        IsLeaf(top.b) ||
        (!IsLeaf(top.a) && BallOf(top.a).radius > B.BallOf(top.b).radius);
    const Group& group = split_A ? groups_[static_cast<size_t>(top.a)]
                                 : B.groups_[static_cast<size_t>(top.b)];
    for (int lane = 0; lane < kLanes && group.radii[lane] >= 0.0F; ++lane) {
      const int child = group.children[static_cast<size_t>(lane)];
      if (split_A) {
        enter(child, top.b);
      } else {
        enter(top.a, child);
      }
    }
  }
  return best;
}

// The first point that falls into a cell of a grid stands for all that do:
// corners first, then small pieces of the triangles.
std::vector<SphereTree::Ball> SphereTree::SpreadProbes(
    const TriangleMesh& mesh_L, double spacing) {
  std::vector<Ball> balls;
  std::map<std::array<int, 3>, int> cells;
  const auto add = [&](const Eigen::Vector3d& p, double radius) {
    const Eigen::Vector3d u = p / spacing;
    const std::array<int, 3> cell{static_cast<int>(std::floor(u.x())),
                                  static_cast<int>(std::floor(u.y())),
                                  static_cast<int>(std::floor(u.z()))};
    const auto [it, is_new] =
        cells.try_emplace(cell, static_cast<int>(balls.size()));
    if (is_new) balls.push_back({p, 0.0});
    Ball& ball = balls[it->second];
    ball.radius = std::max(ball.radius, (p - ball.p).norm() + radius);
  };
  for (const Eigen::Vector3d& p : mesh_L.vertices()) add(p, 0.0);
  std::vector<SurfacePatch> stack;
  for (int f = 0; f < mesh_L.num_triangles(); ++f) {
    stack.push_back(MakeSurfacePatch(
        {mesh_L.corner(f, 0), mesh_L.corner(f, 1), mesh_L.corner(f, 2)}));
    while (!stack.empty()) {
      const SurfacePatch patch = stack.back();
      stack.pop_back();
      if (patch.radius <= 0.5 * spacing) {
        add(patch.p, patch.radius);
      } else {
        for (const SurfacePatch& half : SplitPatch(patch)) {
          stack.push_back(half);
        }
      }
    }
  }
  return balls;
}

SphereTree::Ball SphereTree::Enclose(const std::vector<Ball>& balls, int first,
                                     int count) {
  const auto begin = balls.begin() + first;
  const auto end = begin + count;
  Eigen::Vector3d low = begin->p, high = begin->p;
  for (auto it = begin; it != end; ++it) {
    low = low.cwiseMin(it->p);
    high = high.cwiseMax(it->p);
  }
  Ball ball{0.5 * (low + high), 0.0};
  for (auto it = begin; it != end; ++it) {
    ball.radius = std::max(ball.radius, (it->p - ball.p).norm() + it->radius);
  }
  return ball;
}

// Sorts them along their longest side and cuts them in the middle, so that the
// first half fills its leaves. @returns how many are in it.
int SphereTree::Split(std::vector<Ball>& balls, int first, int count) {
  const auto begin = balls.begin() + first;
  Eigen::Vector3d low = begin->p, high = begin->p;
  for (auto it = begin; it != begin + count; ++it) {
    low = low.cwiseMin(it->p);
    high = high.cwiseMax(it->p);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  std::stable_sort(begin, begin + count, [axis](const Ball& a, const Ball& b) {
    return a.p[axis] < b.p[axis];
  });
  return kLanes * ((count + 2 * kLanes - 1) / (2 * kLanes));
}

// @returns the child: a leaf for up to four balls, else a group; the group 0
// when it is still empty.
int SphereTree::Build(std::vector<Ball>& balls, int first, int count) {
  if (count <= kLanes) {
    Leaf leaf;
    leaf.first = first;
    leaf.count = count;
    for (int lane = 0; lane < kLanes; ++lane) {
      const int i = first + (lane < count ? lane : 0);
      leaf.probes.Set(lane, balls[static_cast<size_t>(i)].p);
    }
    leaves_.push_back(leaf);
    leaf_balls_.push_back(Enclose(balls, first, count));
    return ~static_cast<int>(leaves_.size() - 1);
  }
  int self = 0;
  if (group_balls_[0].radius > 0.0) {
    self = static_cast<int>(groups_.size());
    groups_.emplace_back();
    group_balls_.emplace_back();
  }
  group_balls_[static_cast<size_t>(self)] = Enclose(balls, first, count);
  // Halves, and halves of those that are more than a leaf.
  std::vector<std::pair<int, int>> pieces;
  const int half = Split(balls, first, count);
  for (const auto& [begin, size] :
       {std::pair(first, half), std::pair(first + half, count - half)}) {
    if (size <= kLanes) {
      pieces.emplace_back(begin, size);
      continue;
    }
    const int quarter = Split(balls, begin, size);
    pieces.emplace_back(begin, quarter);
    if (size > quarter) pieces.emplace_back(begin + quarter, size - quarter);
  }
  for (size_t lane = 0; lane < pieces.size(); ++lane) {
    const int child = Build(balls, pieces[lane].first, pieces[lane].second);
    Group& group = groups_[static_cast<size_t>(self)];
    group.children[lane] = child;
    group.centers.Set(static_cast<int>(lane), BallOf(child).p);
    group.radii[lane] =
        CalcRoundedRadius(BallOf(child).p, BallOf(child).radius);
  }
  return self;
}

}  // namespace graspdb
