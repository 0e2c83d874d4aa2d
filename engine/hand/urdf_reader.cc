#include "engine/hand/urdf_reader.h"

#include <utility>

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include "engine/base/utf8.h"

namespace graspdb {
namespace {

Eigen::Vector3d ToEigen(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

RigidTransform ToRigidTransform(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return {
      Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix(),
      ToEigen(pose.position)};
}

Result<HandTree::Joint> ToJoint(const urdf::Joint& source) {
  HandTree::Joint joint;
  joint.name = source.name;
  if (source.type == urdf::Joint::PRISMATIC) {
    joint.type = JointType::kPrismatic;
  } else if (source.type == urdf::Joint::FIXED) {
    return MakeHandError("joint " + source.name + " is fixed",
                         "move its link's shapes into the parent link");
  } else if (source.type != urdf::Joint::REVOLUTE) {
    return MakeHandError("joint " + source.name +
                         " is neither revolute with limits nor prismatic");
  }
  if (!source.limits)
    return MakeHandError("joint " + source.name + " has no limits");
  joint.X_PJ = ToRigidTransform(source.parent_to_joint_origin_transform);
  joint.axis_J = ToEigen(source.axis).normalized();
  joint.lower = source.limits->lower;
  joint.upper = source.limits->upper;
  if (source.mimic) {
    if (source.mimic->offset != 0.0) {
      return MakeHandError(
          "joint " + source.name + " mimics another with an offset",
          "turn its origin by the offset instead");
    }
    joint.mimicked = source.mimic->joint_name;
    joint.ratio = source.mimic->multiplier;
  }
  return joint;
}

Result<HandTree::Link> ToLink(const urdf::Link& source) {
  HandTree::Link link;
  link.name = source.name;
  if (source.inertial) {
    link.mass = source.inertial->mass;
    link.p_LcCM = ToEigen(source.inertial->origin.position);
  }
  for (const urdf::CollisionSharedPtr& collision : source.collision_array) {
    if (!collision->geometry ||
        collision->geometry->type != urdf::Geometry::MESH) {
      return MakeHandError(
          "link " + source.name + " has a collision shape that is no mesh",
          "give it as a convex mesh");
    }
    const auto& mesh = static_cast<const urdf::Mesh&>(*collision->geometry);
    if (mesh.scale.x != 1.0 || mesh.scale.y != 1.0 || mesh.scale.z != 1.0) {
      return MakeHandError("link " + source.name + " scales " + mesh.filename,
                           "give the mesh in metres");
    }
    link.pieces.push_back({mesh.filename, ToRigidTransform(collision->origin)});
  }
  return link;
}

// The link with all below it.
Result<void> AddLinks(const urdf::ModelInterface& model,
                      const urdf::Link& source, HandTree::Link link,
                      HandTree& tree) {
  const int index = static_cast<int>(tree.links.size());
  tree.links.push_back(std::move(link));
  for (const urdf::JointSharedPtr& joint : source.child_joints) {
    const auto child = model.getLink(joint->child_link_name);
    if (!child) return MakeHandError("joint " + joint->name + " moves no link");
    GRASPDB_TRY(below, ToLink(*child));
    GRASPDB_TRY(moved_by, ToJoint(*joint));
    below.parent = index;
    below.joint = std::move(moved_by);
    GRASPDB_TRY_VOID(AddLinks(model, *child, std::move(below), tree));
  }
  return {};
}

}  // namespace

Result<HandTree> ReadUrdf(const std::string& urdf) {
  // tinyxml 2.6 reads past the end of what is not.
  if (!IsUtf8(urdf)) {
    return MakeHandError("the URDF is not UTF-8 text", "save it as UTF-8");
  }
  // urdfdom 3.0 hands the text that it complains of to printf() as a format.
  console_bridge::noOutputHandler();
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(urdf);
  if (!model) return MakeHandError("the URDF cannot be read");
  const urdf::LinkConstSharedPtr root = model->getRoot();
  if (!root) return MakeHandError("it has no root link");
  HandTree tree;
  GRASPDB_TRY(base, ToLink(*root));
  GRASPDB_TRY_VOID(AddLinks(*model, *root, std::move(base), tree));
  GRASPDB_TRY_VOID(CheckHandTree(tree));
  return tree;
}

}  // namespace graspdb
