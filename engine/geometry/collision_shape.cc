#include "engine/geometry/collision_shape.h"

#include <algorithm>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

namespace graspdb {

struct CollisionShape::Impl {
  fcl::BVHModel<fcl::OBBRSSd> model;
};

CollisionShape::CollisionShape(const TriangleMesh& mesh_A)
    : impl_(std::make_unique<Impl>()) {
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh_A.triangles().size());
  for (const Eigen::Vector3i& t : mesh_A.triangles()) {
    triangles.emplace_back(t[0], t[1], t[2]);
  }
  impl_->model.beginModel();
  impl_->model.addSubModel(mesh_A.vertices(), triangles);
  impl_->model.endModel();
}

CollisionShape::~CollisionShape() = default;
CollisionShape::CollisionShape(CollisionShape&&) noexcept = default;
CollisionShape& CollisionShape::operator=(CollisionShape&&) noexcept = default;

namespace {

fcl::Transform3d ToFcl(const RigidTransform& X_AB) {
  fcl::Transform3d X = fcl::Transform3d::Identity();
  X.linear() = X_AB.rotation;
  X.translation() = X_AB.translation;
  return X;
}

}  // namespace

bool CollisionShape::Intersects(const CollisionShape& other,
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
