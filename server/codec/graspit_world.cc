#include "server/codec/graspit_world.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "engine/base/contract.h"
#include "server/codec/markup.h"

namespace graspdb {
namespace {

constexpr double kMillimetresPerMetre = 1000.0;
// A joint that is this far from where its motor alone would put it, rad, has
// broken away.
constexpr double kCoupled = 1e-6;

// (w x y z)[x y z]
std::string FormatTransform(const RigidTransform& X) {
  const Eigen::Quaterniond q(X.rotation);
  const Eigen::Vector3d p = kMillimetresPerMetre * X.translation;
  return fmt::format("({} {} {} {})[{} {} {}]", q.w(), q.x(), q.y(), q.z(),
                     p.x(), p.y(), p.z());
}

// One degree of freedom as GraspIt! saves it: its value, and for one that may
// break away also a flag per joint, 1 followed by the angle where it stopped.
std::string FormatFreedom(const HandModel& hand, const HandActuator& actuator,
                          const Eigen::VectorXd& q) {
  const int first = actuator.joints.front();
  const int last = actuator.joints.back();
  const HandJoint& outer = hand.joints()[static_cast<size_t>(last)];
  if (outer.breakaway_ratio == 0.0) return fmt::format("{}", q[first]);
  const bool broken = std::abs(q[last] - outer.ratio * q[first]) > kCoupled;
  if (!broken) return fmt::format("{} 0 0", q[first]);
  return fmt::format("{} 1 {} 0", q[last] / outer.ratio, q[first]);
}

std::string FormatRobot(const StoredGrasp& stored, const HandModel& hand,
                        const GraspitModel& model) {
  const HandConfiguration& configuration = stored.grasp.configuration;
  std::string freedoms;
  for (const HandActuator& actuator : hand.actuators()) {
    if (!freedoms.empty()) freedoms += ' ';
    freedoms.append(FormatFreedom(hand, actuator, configuration.q));
  }
  return fmt::format(
      "  <!-- grasp {} -->\n"
      "  <robot>\n"
      "    <filename>{}</filename>\n"
      "    <dofValues>{}</dofValues>\n"
      "    <transform><fullTransform>{}</fullTransform></transform>\n"
      "  </robot>\n",
      stored.id, EscapeMarkup(model.robot), freedoms,
      FormatTransform(configuration.X_OH * model.X_HG));
}

}  // namespace

std::string GraspsToGraspit(const std::vector<const StoredGrasp*>& grasps,
                            const HandModel& hand, const GraspitModel& model) {
  std::string world = "<?xml version=\"1.0\" ?>\n<world>\n";
  std::set<std::string> objects;
  for (const StoredGrasp* grasp : grasps) {
    GRASPDB_EXPECTS(grasp->hand == hand.name());
    if (!objects.insert(grasp->object_id).second) continue;
    world += fmt::format(
        "  <graspableBody>\n"
        "    <filename>models/objects/{}.xml</filename>\n"
        "    <transform><fullTransform>{}</fullTransform></transform>\n"
        "  </graspableBody>\n",
        grasp->object_id, FormatTransform(RigidTransform()));
  }
  for (const StoredGrasp* grasp : grasps) {
    world += FormatRobot(*grasp, hand, model);
  }
  return world + "</world>\n";
}

}  // namespace graspdb
