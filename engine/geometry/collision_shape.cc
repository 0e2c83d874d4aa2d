#include "engine/geometry/collision_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/detail/traversal/collision/intersect.h>
#include <fcl/narrowphase/distance.h>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// Added to each cosine, as in FCL: across edges that are nearly parallel
// nothing separates two boxes but rounding.
constexpr double kRounding = 1e-6;

// One of FCL's boxes around triangles.
struct Box {
  Eigen::Matrix3d axes;    // As columns.
  Eigen::Vector3d center;  // m
  Eigen::Vector3d half;    // Of its sides, along the axes, m.
  double size;             // The larger of two is split.
  int child;               // The first of two, which follow each other, or …
  int triangle;            // … -1, and this.

  bool IsLeaf() const { return child < 0; }
};

// Axes and centre of a box in another frame.
struct PlacedBox {
  Eigen::Matrix3d axes;
  Eigen::Vector3d center;
};

// Whether a plane separates two boxes: across one of their axes, or along an
// edge of each [Gottschalk et al. 1996]. Plain loops: most end soon.
bool AreApart(const Box& a, const PlacedBox& placed_b, const Box& b) {
  const Eigen::Vector3d d = placed_b.center - a.center;
  double t[3];     // From a to b, along a's axes.
  double R[3][3];  // b's axes along a's.
  double absolute[3][3];
  for (int i = 0; i < 3; ++i) {
    t[i] = a.axes.col(i).dot(d);
    double reach = a.half[i];
    for (int j = 0; j < 3; ++j) {
      R[i][j] = a.axes.col(i).dot(placed_b.axes.col(j));
      absolute[i][j] = std::abs(R[i][j]) + kRounding;
      reach += absolute[i][j] * b.half[j];
    }
    if (std::abs(t[i]) > reach) return true;
  }
  for (int j = 0; j < 3; ++j) {
    double along = 0.0;
    double reach = b.half[j];
    for (int i = 0; i < 3; ++i) {
      along += R[i][j] * t[i];
      reach += absolute[i][j] * a.half[i];
    }
    if (std::abs(along) > reach) return true;
  }
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3;
    const int i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3;
      const int j2 = (j + 2) % 3;
      const double along = t[i2] * R[i1][j] - t[i1] * R[i2][j];
      const double reach =
          a.half[i1] * absolute[i2][j] + a.half[i2] * absolute[i1][j] +
          b.half[j1] * absolute[i][j2] + b.half[j2] * absolute[i][j1];
      if (std::abs(along) > reach) return true;
    }
  }
  return false;
}

fcl::Transform3d ToFcl(const RigidTransform& X_AB) {
  fcl::Transform3d X = fcl::Transform3d::Identity();
  X.linear() = X_AB.rotation;
  X.translation() = X_AB.translation;
  return X;
}

}  // namespace

struct CollisionShape::Impl {
  fcl::BVHModel<fcl::OBBRSSd> model;
  std::vector<Box> boxes;  // The root first.
  std::vector<std::array<Eigen::Vector3d, 3>> triangles;

  // FCL's search, with the test of two boxes compiled into it.
  bool BoxMeets(int i, const Impl& other, int j, const PlacedBox& placed,
                const RigidTransform& X_AB) const {
    const Box& a = boxes[static_cast<size_t>(i)];
    const Box& b = other.boxes[static_cast<size_t>(j)];
    if (AreApart(a, placed, b)) return false;
    if (a.IsLeaf() && b.IsLeaf()) {
      const auto& p = triangles[static_cast<size_t>(a.triangle)];
      const auto& q = other.triangles[static_cast<size_t>(b.triangle)];
      return fcl::detail::Intersect<double>::intersect_Triangle(
          p[0], p[1], p[2], q[0], q[1], q[2], X_AB.rotation, X_AB.translation);
    }
    if (b.IsLeaf() || (!a.IsLeaf() && a.size > b.size)) {
      return BoxMeets(a.child, other, j, placed, X_AB) ||
             BoxMeets(a.child + 1, other, j, placed, X_AB);
    }
    return BoxMeets(i, other, b.child, X_AB) ||
           BoxMeets(i, other, b.child + 1, X_AB);
  }
  bool BoxMeets(int i, const Impl& other, int j,
                const RigidTransform& X_AB) const {
    const Box& b = other.boxes[static_cast<size_t>(j)];
    return BoxMeets(i, other, j, {X_AB.rotation * b.axes, X_AB * b.center},
                    X_AB);
  }
};

CollisionShape::CollisionShape(const TriangleMesh& mesh_A)
    : impl_(std::make_unique<Impl>()) {
  GRASPDB_EXPECTS(mesh_A.num_triangles() > 0);
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh_A.triangles().size());
  for (const Eigen::Vector3i& t : mesh_A.triangles()) {
    triangles.emplace_back(t[0], t[1], t[2]);
  }
  impl_->model.beginModel();
  impl_->model.addSubModel(mesh_A.vertices(), triangles);
  impl_->model.endModel();
  for (int i = 0; i < impl_->model.getNumBVs(); ++i) {
    const auto& node = impl_->model.getBV(i);
    const fcl::OBBd& obb = node.bv.obb;
    impl_->boxes.push_back({obb.axis, obb.To, obb.extent, obb.size(),
                            node.isLeaf() ? -1 : node.first_child,
                            node.isLeaf() ? node.primitiveId() : -1});
  }
  for (int f = 0; f < mesh_A.num_triangles(); ++f) {
    impl_->triangles.push_back(
        {mesh_A.corner(f, 0), mesh_A.corner(f, 1), mesh_A.corner(f, 2)});
  }
}

CollisionShape::~CollisionShape() = default;
CollisionShape::CollisionShape(CollisionShape&&) noexcept = default;
CollisionShape& CollisionShape::operator=(CollisionShape&&) noexcept = default;

bool CollisionShape::Intersects(const CollisionShape& other,
                                const RigidTransform& X_AB) const {
  return impl_->BoxMeets(0, *other.impl_, 0, X_AB);
}

bool CollisionShape::IntersectsByFcl(const CollisionShape& other,
                                     const RigidTransform& X_AB) const {
  const fcl::CollisionRequestd request(1, false);
  fcl::CollisionResultd result;
  fcl::collide<double>(&impl_->model, fcl::Transform3d::Identity(),
                       &other.impl_->model, ToFcl(X_AB), request, result);
  return result.isCollision();
}

double CollisionShape::CalcDistance(const CollisionShape& other,
                                    const RigidTransform& X_AB) const {
  const fcl::DistanceRequestd request(false);
  fcl::DistanceResultd result;
  fcl::distance<double>(&impl_->model, fcl::Transform3d::Identity(),
                        &other.impl_->model, ToFcl(X_AB), request, result);
  return std::max(0.0, result.min_distance);
}

}  // namespace graspdb
