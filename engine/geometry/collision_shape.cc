#include "engine/geometry/collision_shape.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/detail/traversal/collision/intersect.h>
#include <fcl/narrowphase/distance.h>

#include "engine/base/contract.h"
#include "engine/math/lanes.h"

namespace graspdb {
namespace {

// Added to each cosine, as in FCL: across edges that are nearly parallel
// nothing separates two boxes but rounding.
constexpr float kRounding = 1e-6F;
// What single precision may be off, as a share of how far the boxes reach.
constexpr double kSlack = 2e-6;

Floats4 ToLanes(const Eigen::Vector3d& v) {
  return Floats4{static_cast<float>(v.x()), static_cast<float>(v.y()),
                 static_cast<float>(v.z()), 0.0F};
}

// A box's axes, one in each lane, by their components; and its centre, m.
struct Placement {
  Floats4 x;
  Floats4 y;
  Floats4 z;
  Floats4 center;
};

// One of FCL's boxes around triangles.
struct Box {
  Placement place;
  Floats4 half;  // Of its sides, along the axes, m.
  float size;    // The larger of two is split.
  int child;     // The first of two, which follow each other, or …
  int triangle;  // … -1, and this.

  bool IsLeaf() const { return child < 0; }
};

Floats4 Abs(const Floats4& v) {
  return std::bit_cast<Floats4>(std::bit_cast<Ints4>(v) & 0x7fffffff);
}
Floats4 Max(const Floats4& a, const Floats4& b) { return a > b ? a : b; }
bool IsAnyPositive(const Floats4& v) {
  using Halves = std::array<uint64_t, 2>;
  const auto halves = std::bit_cast<Halves>(v > Floats4{});
  return (halves[0] | halves[1]) != 0;
}

// Σ v_k rows_k
Floats4 Combine(const Floats4& v, const Floats4& row_0, const Floats4& row_1,
                const Floats4& row_2) {
  return v[0] * row_0 + v[1] * row_1 + v[2] * row_2;
}

// Whether a plane separates two boxes by more than the slack: across one of
// their axes, or along an edge of each [Gottschalk et al. 1996]. Three at once.
bool AreApart(const Placement& A, const Floats4& half_A, const Placement& B,
              const Floats4& half_B, float slack) {
  const auto yzx = [](const Floats4& v) {
    return __builtin_shufflevector(v, v, 1, 2, 0, 3);
  };
  const auto zxy = [](const Floats4& v) {
    return __builtin_shufflevector(v, v, 2, 0, 1, 3);
  };
  // From A to B, along A's axes.
  const Floats4 t = Combine(B.center - A.center, A.x, A.y, A.z);
  // The cosines between B's axis i and all of A's.
  Floats4 abs_B[3];
  for (int i = 0; i < 3; ++i) {
    abs_B[i] = Abs(B.x[i] * A.x + B.y[i] * A.y + B.z[i] * A.z) + kRounding;
  }
  const Floats4 across_A =
      Abs(t) - half_A - Combine(half_B, abs_B[0], abs_B[1], abs_B[2]);
  if (IsAnyPositive(across_A - slack)) return true;
  // Between A's axis i and all of B's.
  Floats4 of_A[3], abs_A[3];
  for (int i = 0; i < 3; ++i) {
    of_A[i] = A.x[i] * B.x + A.y[i] * B.y + A.z[i] * B.z;
    abs_A[i] = Abs(of_A[i]) + kRounding;
  }
  const Floats4 across_B = Abs(Combine(t, of_A[0], of_A[1], of_A[2])) - half_B -
                           Combine(half_A, abs_A[0], abs_A[1], abs_A[2]);
  if (IsAnyPositive(across_B - slack)) return true;
  Floats4 along = Floats4{};
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3;
    const int i2 = (i + 2) % 3;
    const Floats4 reach = half_A[i1] * abs_A[i2] + half_A[i2] * abs_A[i1] +
                          yzx(half_B) * zxy(abs_A[i]) +
                          zxy(half_B) * yzx(abs_A[i]);
    along = Max(along, Abs(t[i2] * of_A[i1] - t[i1] * of_A[i2]) - reach);
  }
  return IsAnyPositive(along - slack);
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
  double reach{0.0};  // From the frame's origin, m.

  // FCL's search of two trees, with the test of two boxes compiled into it.
  class Search {
   public:
    Search(const Impl& A, const Impl& B, const RigidTransform& X_AB)
        : A_(A),
          B_(B),
          X_AB_(X_AB),
          rows_{ToLanes(X_AB.rotation.row(0)), ToLanes(X_AB.rotation.row(1)),
                ToLanes(X_AB.rotation.row(2))},
          columns_{ToLanes(X_AB.rotation.col(0)), ToLanes(X_AB.rotation.col(1)),
                   ToLanes(X_AB.rotation.col(2))},
          shift_(ToLanes(X_AB.translation)),
          slack_(static_cast<float>(
              kSlack * (A.reach + B.reach + X_AB.translation.norm()))) {}

    bool Meets() const { return Meets(0, 0); }

   private:
    bool Meets(int i, int j) const {
      const Box& b = B_.boxes[static_cast<size_t>(j)];
      const auto turn = [&b, this](int k) {
        return Combine(rows_[k], b.place.x, b.place.y, b.place.z);
      };
      return Meets(i, j,
                   {turn(0), turn(1), turn(2),
                    shift_ + Combine(b.place.center, columns_[0], columns_[1],
                                     columns_[2])});
    }

    bool Meets(int i, int j, const Placement& placed_b) const {
      const Box& a = A_.boxes[static_cast<size_t>(i)];
      const Box& b = B_.boxes[static_cast<size_t>(j)];
      if (AreApart(a.place, a.half, placed_b, b.half, slack_)) return false;
      if (a.IsLeaf() && b.IsLeaf()) {
        const auto& p = A_.triangles[static_cast<size_t>(a.triangle)];
        const auto& q = B_.triangles[static_cast<size_t>(b.triangle)];
        return fcl::detail::Intersect<double>::intersect_Triangle(
            p[0], p[1], p[2], q[0], q[1], q[2], X_AB_.rotation,
            X_AB_.translation);
      }
      if (b.IsLeaf() || (!a.IsLeaf() && a.size > b.size)) {
        return Meets(a.child, j, placed_b) || Meets(a.child + 1, j, placed_b);
      }
      return Meets(i, b.child) || Meets(i, b.child + 1);
    }

    const Impl& A_;
    const Impl& B_;
    const RigidTransform& X_AB_;
    const std::array<Floats4, 3> rows_;  // Of the rotation.
    const std::array<Floats4, 3> columns_;
    const Floats4 shift_;
    const float slack_;
  };
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
    impl_->boxes.push_back({{ToLanes(obb.axis.row(0)), ToLanes(obb.axis.row(1)),
                             ToLanes(obb.axis.row(2)), ToLanes(obb.To)},
                            ToLanes(obb.extent),
                            static_cast<float>(obb.size()),
                            node.isLeaf() ? -1 : node.first_child,
                            node.isLeaf() ? node.primitiveId() : -1});
  }
  for (int f = 0; f < mesh_A.num_triangles(); ++f) {
    impl_->triangles.push_back(
        {mesh_A.corner(f, 0), mesh_A.corner(f, 1), mesh_A.corner(f, 2)});
  }
  for (const Eigen::Vector3d& p : mesh_A.vertices()) {
    impl_->reach = std::max(impl_->reach, p.norm());
  }
}

CollisionShape::~CollisionShape() = default;
CollisionShape::CollisionShape(CollisionShape&&) noexcept = default;
CollisionShape& CollisionShape::operator=(CollisionShape&&) noexcept = default;

bool CollisionShape::Intersects(const CollisionShape& other,
                                const RigidTransform& X_AB) const {
  return Impl::Search(*impl_, *other.impl_, X_AB).Meets();
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
