#include "engine/geometry/sphere_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "engine/base/contract.h"
#include "engine/geometry/surface_patch.h"

namespace graspdb {
namespace {

constexpr int kProbesPerLeaf = 6;

}  // namespace

SphereTree::SphereTree(const TriangleMesh& mesh_L, double spacing) {
  GRASPDB_EXPECTS(mesh_L.num_triangles() > 0 && spacing > 0.0);
  std::vector<Ball> balls = SpreadProbes(mesh_L, spacing);
  nodes_.emplace_back();
  Build(0, 0, static_cast<int>(balls.size()), balls);
  for (const Ball& ball : balls) probes_.push_back(ball.p);
}

double SphereTree::CalcGapBound(const SphereTree& B, const RigidTransform& X_AB,
                                double enough) const {
  struct Pair {
    int a, b;
    double bound;
  };
  double best = 1e300;
  std::vector<Pair> stack;
  const auto enter = [&](int a, int b) {
    const Node& node_A = nodes_[a];
    const Node& node_B = B.nodes_[b];
    const double apart = (node_A.center - X_AB * node_B.center).norm();
    const double radii = node_A.radius + node_B.radius;
    const bool small = node_A.num_probes > 0 && node_B.num_probes > 0;
    // Far enough for their size: looking closer would gain little.
    if (small || radii <= 0.5 * apart) {
      best = std::min(best, apart - radii);
    } else if (apart - radii < best) {
      stack.push_back({a, b, apart - radii});
    }
  };
  enter(0, 0);
  while (!stack.empty() && best >= enough) {
    const Pair top = stack.back();
    stack.pop_back();
    if (top.bound >= best) continue;
    const Node& node_A = nodes_[top.a];
    const Node& node_B = B.nodes_[top.b];
    const bool split_A =
        node_B.num_probes > 0 ||
        (node_A.num_probes == 0 && node_A.radius > node_B.radius);
    for (int child = 0; child < 2; ++child) {
      if (split_A) {
        enter(node_A.first + child, top.b);
      } else {
        enter(top.a, node_B.first + child);
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

void SphereTree::Build(int node, int first, int count,
                       std::vector<Ball>& balls) {
  const auto begin = balls.begin() + first;
  const auto end = begin + count;
  Eigen::Vector3d low = begin->p, high = begin->p;
  for (auto it = begin; it != end; ++it) {
    low = low.cwiseMin(it->p);
    high = high.cwiseMax(it->p);
  }
  Node result;
  result.center = 0.5 * (low + high);
  for (auto it = begin; it != end; ++it) {
    result.radius =
        std::max(result.radius, (it->p - result.center).norm() + it->radius);
  }
  if (count <= kProbesPerLeaf) {
    result.first = first;
    result.num_probes = count;
    nodes_[node] = result;
    return;
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  std::stable_sort(begin, end, [axis](const Ball& a, const Ball& b) {
    return a.p[axis] < b.p[axis];
  });
  result.first = static_cast<int>(nodes_.size());
  nodes_[node] = result;
  nodes_.emplace_back();
  nodes_.emplace_back();
  Build(result.first, first, count / 2, balls);
  Build(result.first + 1, first + count / 2, count - count / 2, balls);
}

}  // namespace graspdb
