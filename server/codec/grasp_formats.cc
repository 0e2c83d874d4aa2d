#include "server/codec/grasp_formats.h"

#include <algorithm>

#include <fmt/format.h>

#include "server/codec/json.h"

namespace graspdb {
namespace {

constexpr char kObjectFrame[] = "object";

/** Quoted where RFC 4180 asks for it. */
std::string CsvCell(const std::string& text) {
  if (text.find_first_of("\",\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::vector<std::string> CollectJointNames(
    const std::vector<GraspOfHand>& grasps) {
  std::vector<std::string> names;
  for (const auto& [grasp, hand] : grasps) {
    for (const HandJoint& joint : hand->joints()) {
      if (std::find(names.begin(), names.end(), joint.name) == names.end()) {
        names.push_back(joint.name);
      }
    }
  }
  return names;
}

std::string CsvJoint(const GraspOfHand& pair, const std::string& name) {
  const auto& joints = pair.hand->joints();
  for (int i = 0; i < pair.hand->num_joints(); ++i) {
    if (joints[static_cast<size_t>(i)].name == name) {
      return fmt::format("{}", pair.grasp->grasp.configuration.q[i]);
    }
  }
  return "";
}

Json RosHeader(const char* frame) {
  return {
      {"seq", 0}, {"stamp", {{"secs", 0}, {"nsecs", 0}}}, {"frame_id", frame}};
}

Json RosVector(const Eigen::Vector3d& v) {
  return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}};
}

/** trajectory_msgs/JointTrajectory with one point. */
Json RosPosture(const HandModel& hand, const Eigen::VectorXd& q) {
  Json names = Json::array();
  for (const HandJoint& joint : hand.joints()) names.push_back(joint.name);
  const Json point = {
      {"positions", std::vector<double>(q.data(), q.data() + q.size())},
      {"velocities", Json::array()},
      {"accelerations", Json::array()},
      {"effort", Json::array()},
      {"time_from_start", {{"secs", 0}, {"nsecs", 0}}}};
  return {{"header", RosHeader("")},
          {"joint_names", names},
          {"points", Json::array({point})}};
}

/** moveit_msgs/GripperTranslation. */
Json RosTranslation(const Eigen::Vector3d& direction_O, double distance) {
  return {{"direction",
           {{"header", RosHeader(kObjectFrame)},
            {"vector", RosVector(direction_O)}}},
          {"desired_distance", distance},
          {"min_distance", 0.0}};
}

Json RosGrasp(const StoredGrasp& stored, const HandModel& hand) {
  const Grasp& grasp = stored.grasp;
  const RigidTransform& X_OH = grasp.configuration.X_OH;
  const Eigen::Quaterniond q_OH(X_OH.rotation);
  const Json pose = {
      {"position", RosVector(X_OH.translation)},
      {"orientation",
       {{"x", q_OH.x()}, {"y", q_OH.y()}, {"z", q_OH.z()}, {"w", q_OH.w()}}}};
  return {
      {"id", stored.id},
      {"pre_grasp_posture", RosPosture(hand, grasp.q_pregrasp)},
      {"grasp_posture", RosPosture(hand, grasp.configuration.q)},
      {"grasp_pose", {{"header", RosHeader(kObjectFrame)}, {"pose", pose}}},
      {"grasp_quality", grasp.quality.epsilon},
      {"pre_grasp_approach", RosTranslation(grasp.approach_O, grasp.retreat)},
      {"post_grasp_retreat", RosTranslation(-grasp.approach_O, grasp.retreat)},
      {"post_place_retreat", RosTranslation(-grasp.approach_O, grasp.retreat)},
      {"max_contact_force", hand.closing_force()},
      {"allowed_touch_objects", Json::array({kObjectFrame})}};
}

}  // namespace

std::string GraspsToCsv(const std::vector<GraspOfHand>& grasps) {
  const std::vector<std::string> joints = CollectJointNames(grasps);
  std::string csv =
      "id,object,part,hand,stage,epsilon,x,y,z,qx,qy,qz,qw,"
      "approach_x,approach_y,approach_z,retreat";
  for (const std::string& joint : joints)
    csv.append(",").append(CsvCell(joint));
  csv += "\r\n";
  for (const GraspOfHand& pair : grasps) {
    const StoredGrasp& stored = *pair.grasp;
    const Grasp& grasp = stored.grasp;
    const RigidTransform& X_OH = grasp.configuration.X_OH;
    const Eigen::Vector3d& p = X_OH.translation;
    const Eigen::Quaterniond q(X_OH.rotation);
    const Eigen::Vector3d& a = grasp.approach_O;
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
                       CsvCell(stored.id), CsvCell(stored.object_id),
                       CsvCell(stored.part_label), CsvCell(stored.hand),
                       ToString(stored.stage), grasp.quality.epsilon, p.x(),
                       p.y(), p.z(), q.x(), q.y(), q.z(), q.w(), a.x(), a.y(),
                       a.z(), grasp.retreat);
    for (const std::string& joint : joints) {
      csv.append(",").append(CsvJoint(pair, joint));
    }
    csv += "\r\n";
  }
  return csv;
}

std::string GraspsToRos(const std::vector<GraspOfHand>& grasps) {
  Json list = Json::array();
  for (const auto& [grasp, hand] : grasps) {
    list.push_back(RosGrasp(*grasp, *hand));
  }
  return list.dump();
}

}  // namespace graspdb
