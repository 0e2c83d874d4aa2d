#include "engine/quality/grip_balance.h"

#include <algorithm>
#include <limits>

#include "engine/math/nonnegative_least_squares.h"
#include "engine/quality/wrench_space.h"

namespace graspdb {
namespace {

// A joint that contacts load.
struct LoadedJoint {
  Eigen::Vector3d p_OJ;
  Eigen::Vector3d axis_O;  // About, or along, which it closes.
  bool slides{false};
  double lever{1.0};  // To its farthest point, m.
  int joint{0};
  bool locks{false};  // Its motor goes on to turn a joint further out.
};

std::vector<LoadedJoint> FindLoadedJoints(
    const HandShape& hand, const RigidTransform& X_OH,
    const std::vector<RigidTransform>& X_HL,
    const std::vector<Contact>& contacts) {
  const HandModel& model = hand.model();
  std::vector<LoadedJoint> loaded;
  for (int j = 0; j < model.num_joints(); ++j) {
    const HandJoint& joint = model.joints()[static_cast<size_t>(j)];
    if (!model.actuators()[static_cast<size_t>(joint.actuator)].closes) {
      continue;
    }
    if (std::none_of(contacts.begin(), contacts.end(), [&](const Contact& c) {
          return hand.motion_bound(c.link, j) > 0.0;
        })) {
      continue;
    }
    const RigidTransform X_OJ =
        X_OH * X_HL[static_cast<size_t>(joint.child_link)];
    LoadedJoint one{X_OJ.translation,
                    joint.closing_sign() * (X_OJ.rotation * joint.axis_J)};
    one.slides = joint.type == JointType::kPrismatic;
    one.joint = j;
    const std::vector<int>& chain =
        model.actuators()[static_cast<size_t>(joint.actuator)].joints;
    for (auto outer = std::find(chain.begin(), chain.end(), j);
         ++outer != chain.end();) {
      one.locks =
          one.locks ||
          model.joints()[static_cast<size_t>(*outer)].breakaway_ratio > 0.0;
    }
    one.lever = hand.lever(j);
    loaded.push_back(one);
  }
  return loaded;
}

}  // namespace

double CalcGripResidual(const HandShape& hand, const RigidTransform& X_OH,
                        const std::vector<RigidTransform>& X_HL,
                        const std::vector<Contact>& contacts,
                        const MassProperties& mass,
                        const ContactParameters& contact_parameters,
                        const GripParameters& parameters,
                        const MotorParameters& motors, double enough) {
  if (contacts.size() < 2) return std::max(parameters.push, 1.0);
  ContactParameters cones = contact_parameters;
  cones.friction *= parameters.friction_share;
  const Wrenches wrenches = CalcContactWrenches(contacts, mass, cones);
  const std::vector<LoadedJoint> joints =
      FindLoadedJoints(hand, X_OH, X_HL, contacts);
  const auto m = static_cast<Eigen::Index>(joints.size());
  const Eigen::Index n = wrenches.cols();
  const Eigen::Index edges = n / static_cast<Eigen::Index>(contacts.size());

  // Unknown: the forces along the cones' edges, how much more than the least a
  // joint bears, and how much less than the most.
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6 + 2 * m, n + 2 * m);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(6 + 2 * m);
  A.topLeftCorner(6, n) = wrenches;
  for (Eigen::Index r = 0; r < m; ++r) {
    const LoadedJoint& joint = joints[static_cast<size_t>(r)];
    for (Eigen::Index k = 0; k < n; ++k) {
      const Contact& contact = contacts[static_cast<size_t>(k / edges)];
      if (hand.motion_bound(contact.link, joint.joint) == 0.0) continue;
      const Eigen::Vector3d force = wrenches.col(k).head<3>();
      A(6 + r, k) =
          joint.slides
              ? joint.axis_O.dot(force)
              : joint.axis_O.dot((contact.p_O - joint.p_OJ).cross(force)) /
                    joint.lever;
    }
    A(6 + r, n + r) = -1.0;
    b[6 + r] = parameters.least_force;
    A(6 + m + r, n + r) = 1.0;
    A(6 + m + r, n + m + r) = 1.0;
  }
  const NonnegativeLeastSquares problem(A);
  // Pushes change little: each search sets out from the last one's forces.
  Eigen::VectorXd forces = Eigen::VectorXd::Zero(A.cols());
  const auto calc_residual = [&](double most) {
    for (Eigen::Index r = 0; r < m; ++r) {
      b[6 + m + r] =
          (joints[static_cast<size_t>(r)].locks ? motors.holding_force : most) -
          parameters.least_force;
    }
    forces = problem.Solve(b, forces);
    return (A * forces - b).norm();
  };
  double worst = calc_residual(motors.closing_force);
  for (int i = 0; i < 6 && worst <= enough; ++i) {
    b.head<3>().setZero();
    b[i / 2] = (i % 2 == 0 ? -1.0 : 1.0) * parameters.push;
    worst = std::max(worst, calc_residual(motors.holding_force));
  }
  return worst < kNoGripResidual ? 0.0 : worst;
}

}  // namespace graspdb
