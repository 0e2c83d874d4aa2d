#include "engine/hand/hand_reader.h"

#include <map>

#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

namespace graspdb {
namespace {

Eigen::Vector3d ToEigen(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

RigidTransform ToRigidTransform(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return {
      Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix(),
      ToEigen(pose.position)};
}

Error Fault(const std::string& what) {
  return Error{ErrorCode::kUnusableInput, "hand description: " + what};
}

// Turns URDF plus annotations into HandModel::Data, one concern per method.
class HandBuilder {
 public:
  HandBuilder(const urdf::ModelInterface& urdf, const HandAnnotations& notes,
              const MeshLoader& load_mesh)
      : urdf_(urdf), notes_(notes), load_mesh_(load_mesh) {}

  Result<HandModel> Build() {
    data_.name = notes_.name;
    data_.approach_H = notes_.approach_H.normalized();
    data_.closing_force = notes_.closing_force;
    const urdf::LinkConstSharedPtr root = urdf_.getRoot();
    if (!root) return Fault("it has no root link");
    GRASPDB_TRY_VOID(AddLink(*root, -1, -1));
    GRASPDB_TRY_VOID(AddActuators());
    GRASPDB_TRY_VOID(AddBreakaway());
    GRASPDB_TRY_VOID(AddContactPoints());
    for (const auto& [first, second] : notes_.ignored_collisions) {
      GRASPDB_TRY(a, FindLink(first));
      GRASPDB_TRY(b, FindLink(second));
      data_.ignored_collisions.emplace_back(a, b);
    }
    return HandModel(std::move(data_));
  }

 private:
  Result<void> AddLink(const urdf::Link& source, int parent, int joint) {
    const int index = static_cast<int>(data_.links.size());
    link_index_[source.name] = index;
    HandLink link;
    link.name = source.name;
    link.parent = parent;
    link.joint = joint;
    if (source.inertial) {
      link.mass = source.inertial->mass;
      link.p_LcCM = ToEigen(source.inertial->origin.position);
    }
    for (const urdf::CollisionSharedPtr& collision : source.collision_array) {
      if (!collision->geometry ||
          collision->geometry->type != urdf::Geometry::MESH) {
        return Fault("link " + source.name +
                     " has a collision shape that is "
                     "no mesh");
      }
      const auto& mesh = static_cast<const urdf::Mesh&>(*collision->geometry);
      GRASPDB_TRY(piece, load_mesh_(mesh.filename));
      link.pieces_L.push_back(
          CalcTransformed(piece, ToRigidTransform(collision->origin)));
    }
    data_.links.push_back(std::move(link));
    for (const urdf::JointSharedPtr& child : source.child_joints) {
      GRASPDB_TRY(child_joint, AddJoint(*child, index));
      GRASPDB_TRY_VOID(
          AddLink(*urdf_.getLink(child->child_link_name), index, child_joint));
    }
    return {};
  }

  Result<int> AddJoint(const urdf::Joint& source, int parent) {
    HandJoint joint;
    joint.name = source.name;
    if (source.type == urdf::Joint::PRISMATIC) {
      joint.type = JointType::kPrismatic;
    } else if (source.type != urdf::Joint::REVOLUTE) {
      return Fault("joint " + source.name +
                   " is neither revolute with limits nor prismatic");
    }
    if (!source.limits) return Fault("joint " + source.name + " has no limits");
    joint.parent_link = parent;
    joint.child_link = static_cast<int>(data_.links.size());
    joint.X_PJ = ToRigidTransform(source.parent_to_joint_origin_transform);
    joint.axis_J = ToEigen(source.axis).normalized();
    joint.lower = source.limits->lower;
    joint.upper = source.limits->upper;
    joint_index_[source.name] = static_cast<int>(data_.joints.size());
    data_.joints.push_back(joint);
    return joint_index_[source.name];
  }

  // The joint that an actuator drives comes first, then those that mimic it,
  // in tree order, which is proximal to distal.
  Result<void> AddActuators() {
    for (const HandAnnotations::Actuator& note : notes_.actuators) {
      const auto driven = joint_index_.find(note.joint);
      if (driven == joint_index_.end()) {
        return Fault("actuator " + note.name + " drives the unknown joint " +
                     note.joint);
      }
      HandActuator actuator;
      actuator.name = note.name;
      actuator.closes = note.closes;
      actuator.lower = data_.joints[driven->second].lower;
      actuator.upper = data_.joints[driven->second].upper;
      const int index = static_cast<int>(data_.actuators.size());
      for (int j = 0; j < static_cast<int>(data_.joints.size()); ++j) {
        const auto mimic = urdf_.getJoint(data_.joints[j].name)->mimic;
        if (j != driven->second &&
            !(mimic && mimic->joint_name == note.joint)) {
          continue;
        }
        if (j != driven->second) data_.joints[j].ratio = mimic->multiplier;
        data_.joints[j].actuator = index;
        actuator.joints.push_back(j);
      }
      data_.actuators.push_back(std::move(actuator));
    }
    for (const HandJoint& joint : data_.joints) {
      if (joint.actuator < 0) {
        return Fault("joint " + joint.name + " has no actuator");
      }
    }
    return {};
  }

  Result<void> AddBreakaway() {
    for (const HandAnnotations::Breakaway& note : notes_.breakaway) {
      const auto joint = joint_index_.find(note.released_joint);
      if (joint == joint_index_.end() || !joint_index_.contains(note.joint)) {
        return Fault("breakaway names the unknown joint " +
                     note.released_joint);
      }
      data_.joints[joint->second].breakaway_ratio = note.ratio;
    }
    return {};
  }

  Result<void> AddContactPoints() {
    for (const HandAnnotations::ContactPoint& note : notes_.contact_points) {
      GRASPDB_TRY(link, FindLink(note.link));
      data_.contact_points.push_back(
          {link, note.p_L, note.nhat_L.normalized()});
    }
    return {};
  }

  Result<int> FindLink(const std::string& name) const {
    const auto found = link_index_.find(name);
    if (found == link_index_.end()) return Fault("there is no link " + name);
    return found->second;
  }

  const urdf::ModelInterface& urdf_;
  const HandAnnotations& notes_;
  const MeshLoader& load_mesh_;
  HandModel::Data data_;
  std::map<std::string, int> link_index_;
  std::map<std::string, int> joint_index_;
};

}  // namespace

Result<HandModel> ReadHand(const std::string& urdf,
                           const HandAnnotations& annotations,
                           const MeshLoader& load_mesh) {
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(urdf);
  if (!model) return Fault("the URDF cannot be read");
  return HandBuilder(*model, annotations, load_mesh).Build();
}

}  // namespace graspdb
