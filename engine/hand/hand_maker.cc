#include "engine/hand/hand_maker.h"

#include <map>
#include <utility>

namespace graspdb {
namespace {

// How far a convex piece may be dented, m.
constexpr double kDent = 1e-4;

// What hand.json or a mesh is to blame for.
Error Fault(const std::string& what, std::string hint = "",
            std::string field = "hand") {
  return MakeHandError(what, std::move(hint), std::move(field));
}

// Whether no vertex stands out of any face's plane.
bool IsConvex(const TriangleMesh& mesh) {
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    const Eigen::Vector3d normal = mesh.normal(f);
    const double height = normal.dot(mesh.corner(f, 0)) + kDent;
    for (const Eigen::Vector3d& p : mesh.vertices()) {
      if (normal.dot(p) > height) return false;
    }
  }
  return true;
}

// Turns a tree plus annotations into HandModel::Data, one concern per method.
class HandBuilder {
 public:
  HandBuilder(const HandTree& tree, const HandAnnotations& notes,
              const MeshLoader& load_mesh)
      : tree_(tree), notes_(notes), load_mesh_(load_mesh) {}

  Result<HandModel> Build() {
    data_.name = notes_.name;
    data_.approach_H = notes_.approach_H.normalized();
    data_.closing_force = notes_.closing_force;
    for (const HandTree::Link& link : tree_.links) {
      GRASPDB_TRY_VOID(AddLink(link));
    }
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
  // With the joint that moves it: the j-th joint moves link j + 1.
  Result<void> AddLink(const HandTree::Link& source) {
    const int index = static_cast<int>(data_.links.size());
    link_index_[source.name] = index;
    HandLink link;
    link.name = source.name;
    link.parent = source.parent;
    link.mass = source.mass;
    link.p_LcCM = source.p_LcCM;
    if (index > 0) {
      link.joint = static_cast<int>(data_.joints.size());
      AddJoint(source, index);
    }
    for (const HandTree::Piece& piece : source.pieces) {
      GRASPDB_TRY(mesh, load_mesh_(piece.mesh));
      if (mesh.num_triangles() > kMostPieceTriangles) {
        return Fault(piece.mesh + " has more than 5000 triangles",
                     "decimate it: it need only show a convex shape", "mesh");
      }
      if (!IsConvex(mesh)) {
        return Fault(piece.mesh + " is not convex",
                     "cut the link's shape into convex meshes", "mesh");
      }
      link.pieces_L.push_back(CalcTransformed(mesh, piece.X_LM));
    }
    data_.links.push_back(std::move(link));
    return {};
  }

  void AddJoint(const HandTree::Link& link, int child) {
    HandJoint joint;
    joint.name = link.joint.name;
    joint.type = link.joint.type;
    joint.parent_link = link.parent;
    joint.child_link = child;
    joint.X_PJ = link.joint.X_PJ;
    joint.axis_J = link.joint.axis_J;
    joint.lower = link.joint.lower;
    joint.upper = link.joint.upper;
    joint_index_[joint.name] = static_cast<int>(data_.joints.size());
    data_.joints.push_back(std::move(joint));
  }

  // The joint that an actuator drives comes first, then those that mimic it,
  // in tree order, which is proximal to distal.
  Result<void> AddActuators() {
    bool closes = false;
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
      closes = closes || note.closes;
      GRASPDB_TRY_VOID(Drive(driven->second, actuator));
      for (int j = 0; j < static_cast<int>(data_.joints.size()); ++j) {
        const HandTree::Joint& mimic = tree_.links[j + 1].joint;
        if (j == driven->second || mimic.mimicked != note.joint) continue;
        data_.joints[j].ratio = mimic.ratio;
        GRASPDB_TRY_VOID(Drive(j, actuator));
      }
      data_.actuators.push_back(std::move(actuator));
    }
    for (const HandJoint& joint : data_.joints) {
      if (joint.actuator < 0) {
        return Fault("joint " + joint.name + " has no actuator",
                     "name one in hand.json, or let it mimic a driven joint");
      }
    }
    if (!closes) return Fault("no actuator closes the hand");
    return {};
  }

  Result<void> Drive(int j, HandActuator& actuator) {
    HandJoint& joint = data_.joints[j];
    if (joint.actuator >= 0) {
      return Fault("joint " + joint.name + " has two actuators");
    }
    joint.actuator = static_cast<int>(data_.actuators.size());
    actuator.joints.push_back(j);
    return {};
  }

  Result<void> AddBreakaway() {
    for (const HandAnnotations::Breakaway& note : notes_.breakaway) {
      const auto joint = joint_index_.find(note.released_joint);
      if (joint == joint_index_.end() || !joint_index_.contains(note.joint)) {
        return Fault("breakaway names the unknown joint " +
                     note.released_joint);
      }
      if (!(note.ratio > 0.0 && note.ratio < 100.0)) {
        return Fault("breakaway of " + note.released_joint +
                     " has no ratio above 0");
      }
      HandJoint& released = data_.joints[joint->second];
      if (released.ratio < 0.0) {
        return Fault(
            "breakaway of " + note.released_joint + ", which mimics backwards",
            "turn its axis round in the URDF, and let it mimic "
            "forwards");
      }
      released.breakaway_ratio = note.ratio;
    }
    return {};
  }

  Result<void> AddContactPoints() {
    for (const HandAnnotations::ContactPoint& note : notes_.contact_points) {
      GRASPDB_TRY(link, FindLink(note.link));
      if (!note.p_L.allFinite() || !(note.nhat_L.norm() > 0.5)) {
        return Fault("a contact point of link " + note.link +
                     " has no place or no direction");
      }
      data_.contact_points.push_back(
          {link, note.p_L, note.nhat_L.normalized()});
    }
    if (data_.contact_points.empty()) {
      return Fault("it has no contact points",
                   "say in hand.json where the hand likes to touch");
    }
    return {};
  }

  Result<int> FindLink(const std::string& name) const {
    const auto found = link_index_.find(name);
    if (found == link_index_.end()) return Fault("there is no link " + name);
    return found->second;
  }

  const HandTree& tree_;
  const HandAnnotations& notes_;
  const MeshLoader& load_mesh_;
  HandModel::Data data_;
  std::map<std::string, int> link_index_;
  std::map<std::string, int> joint_index_;
};

}  // namespace

Result<HandModel> MakeHand(const HandTree& tree,
                           const HandAnnotations& annotations,
                           const MeshLoader& load_mesh) {
  return HandBuilder(tree, annotations, load_mesh).Build();
}

}  // namespace graspdb
