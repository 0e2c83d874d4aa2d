#include "engine/dynamics/closing_simulation.h"

#include <algorithm>
#include <cmath>

#include "engine/dynamics/touch_finder.h"

namespace graspdb {
namespace {

// What a motor weighs behind its gear, kg m², and how fast its swings die.
constexpr double kArmature = 0.0007;
constexpr double kDampingSeconds = 0.002;  // Damping over stiffness.
// A slide is as stiff at the tip as a finger of a decimetre, and as fast.
constexpr double kSlideLength = 0.1;  // m per rad.
constexpr double kLeastLever = 0.01;  // Of a link without a shape, m.
// Probes of the links that may touch the surface within a step are those as
// near as what turns and the object move in it, times a margin, plus a skin, m.
constexpr double kMargin = 1.2;
constexpr double kSkin = 3e-5;
// Below this speed, m/s, what rubs is taken to stick.
constexpr double kStickingSpeed = 1e-4;
// Passes in which the contacts of a step find out whether they press and slip.
constexpr int kPasses = 2;
// A joint slower than this share of its motor is blocked.
constexpr double kStalled = 0.1;
// An object all of whose points are slower than this is at rest, m/s.
constexpr double kCalmSpeed = 0.005;
// Fingers that are away from a still object move on without a simulation, until
// they are as near as this, m …
constexpr double kLeapNear = 0.001;
// … if that is worth so many steps. Still is slower than this, m/s, for so many
// steps.
constexpr int kLeapSteps = 4;
constexpr double kStillSpeed = 0.001;
constexpr int kStillSteps = 5;
constexpr double kLongestClosing = 4.0;  // s.
constexpr double kRampSeconds = 0.1;

Eigen::Matrix3d MakeCross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

}  // namespace

ClosingSimulation::ClosingSimulation(const HandShape& hand, const Solid& solid,
                                     const HoldParameters& parameters,
                                     const MotorParameters& motors)
    : hand_(hand),
      solid_(solid),
      parameters_(parameters),
      movers_(static_cast<size_t>(hand.model().num_links())) {
  for (const HandActuator& actuator : hand.model().actuators()) {
    if (!actuator.closes) continue;
    for (const int j : actuator.joints) {
      const HandJoint& joint = hand.model().joints()[static_cast<size_t>(j)];
      const bool slides = joint.type == JointType::kPrismatic;
      const double length = slides ? kSlideLength : 1.0;
      ClosingJoint one;
      one.joint = j;
      one.is_first = j == actuator.joints.front();
      one.sign = joint.closing_sign();
      one.limit = joint.closing_limit();
      one.speed = joint.ratio * parameters.closing_speed * length;
      one.released_speed =
          joint.breakaway_ratio > 0.0
              ? joint.breakaway_ratio * parameters.closing_speed * length
              : one.speed;
      const double lever = std::max(hand.lever(j), kLeastLever);
      for (int link = 0; link < hand.model().num_links(); ++link) {
        if (hand.motion_bound(link, j) > 0.0) {
          movers_[static_cast<size_t>(link)].push_back(
              static_cast<int>(joints_.size()));
        }
      }
      one.stiffness = parameters.stiffness / (length * length);
      one.damping = kDampingSeconds * one.stiffness;
      one.armature = kArmature / (length * length);
      one.closing_torque = motors.closing_force * lever;
      one.holding_torque = motors.holding_force * lever;
      near_ = std::max(
          near_, kMargin * parameters.time_step * std::abs(one.speed) * lever);
      joints_.push_back(one);
    }
  }
  // Joints that move one link touch the object together.
  std::vector<std::pair<int, int>> couples;
  for (const std::vector<int>& movers : movers_) {
    for (size_t i = 1; i < movers.size(); ++i) {
      couples.emplace_back(movers[i - 1], movers[i]);
    }
  }
  system_ = ArrowSystem(static_cast<int>(joints_.size()), couples);
}

// One closing. The world W is the object's frame before it moved.
class ClosingRun {
 public:
  ClosingRun(const ClosingSimulation& simulation, const RigidTransform& X_WH,
             const Eigen::VectorXd& q, double friction)
      : simulation_(simulation),
        parameters_(simulation.parameters_),
        hand_(simulation.hand_),
        solid_(simulation.solid_),
        joints_(simulation.joints_),
        friction_(friction),
        X_WH_(X_WH),
        finder_(hand_, solid_, simulation.near_),
        free_(simulation.system_),
        touching_(simulation.system_) {
    state_.q = q;
    state_.p_WC = solid_.mass().p_McCM;
    state_.velocity =
        Eigen::VectorXd::Zero(6 + static_cast<Eigen::Index>(joints_.size()));
    blocked_.assign(joints_.size(), false);
    speeds_.assign(joints_.size(), 0.0);
    twists_.resize(joints_.size());
    state_.motors.resize(static_cast<Eigen::Index>(joints_.size()));
    for (size_t k = 0; k < joints_.size(); ++k) {
      state_.motors[static_cast<Eigen::Index>(k)] = q[joints_[k].joint];
    }
  }

  ClosingOutcome Run(Push push) {
    ClosingOutcome outcome;
    const State start = state_;
    double rest = 0.0;
    int still = kStillSteps;
    for (double t = 0.0;
         t < kLongestClosing && rest < parameters_.settle_seconds;
         t += parameters_.time_step) {
      const bool turns = TurnMotors();
      if (turns && still >= kStillSteps) {
        const double seconds = Leap();
        t += seconds;
        if (seconds == 0.0) still = 0;
      }
      Step(Eigen::Vector3d::Zero());
      if (IsLost(start, outcome.shift, outcome.turn)) return outcome;
      still = CalcObjectSpeed() < kStillSpeed ? still + 1 : 0;
      rest = turns || !IsCalm() ? 0.0 : rest + parameters_.time_step;
    }
    outcome.settled = rest >= parameters_.settle_seconds && !touches_.empty();
    outcome.held = outcome.settled && Withstands(push);
    return outcome;
  }

 private:
  using Twist = Eigen::Matrix<double, 6, 1>;  // v of the point at p_WC, then w.
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  struct State {
    Eigen::VectorXd q;       // All joints …
    Eigen::VectorXd motors;  // … and where the closing ones' motors are.
    Eigen::Matrix3d R_WO{Eigen::Matrix3d::Identity()};
    Eigen::Vector3d p_WC;      // The object's mass centre.
    Eigen::VectorXd velocity;  // The object's v and w, then closing joints.
  };

  // A probe of a link that is, or will be, in contact.
  struct Touch {
    double distance;       // Negative inside.
    Eigen::Vector3d nhat;  // Out of the object.
    Eigen::Vector3d arm;   // From the object's mass centre.
  };

  // Where a link touches: a range of touches_.
  struct Contacts {
    int link;
    size_t begin;
    size_t end;
  };

  RigidTransform CalcObjectPose() const {
    return {state_.R_WO, state_.p_WC - state_.R_WO * solid_.mass().p_McCM};
  }

  // Moves on what turns, unless it touches the object or is near it. @returns
  // the time that this takes, s.
  double Leap() {
    double seconds = kLongestClosing;
    for (size_t k = 0; k < joints_.size(); ++k) {
      if (speeds_[k] == 0.0) continue;
      const double left = joints_[k].limit - state_.q[joints_[k].joint];
      seconds = std::min(seconds, left / speeds_[k]);
    }
    for (const Contacts& contacts : contacts_) {
      if (CalcTurningSpeed(contacts.link) > 0.0) return 0.0;
    }
    const double worth = kLeapSteps * parameters_.time_step;
    if (seconds < worth) return 0.0;
    const RigidTransform X_OH = CalcObjectPose().Inverse() * X_WH_;
    const auto X_HL = CalcLinkPoses(hand_.model(), state_.q);
    for (int link = 0; link < hand_.model().num_links(); ++link) {
      const double speed = CalcTurningSpeed(link);
      if (!hand_.link(link) || speed == 0.0) continue;
      const double gap = EstimateGap(
          *hand_.link(link), X_OH * X_HL[static_cast<size_t>(link)], solid_,
          {kLeapNear + worth * speed, kLeapNear + seconds * speed});
      seconds = std::min(seconds, (gap - kLeapNear) / speed);
      if (seconds < worth) return 0.0;
    }
    for (size_t k = 0; k < joints_.size(); ++k) {
      state_.q[joints_[k].joint] += seconds * speeds_[k];
      state_.motors[static_cast<Eigen::Index>(k)] += seconds * speeds_[k];
    }
    for (int link = 0; link < hand_.model().num_links(); ++link) {
      finder_.Move(link, seconds * CalcTurningSpeed(link));
    }
    return seconds;
  }

  // How fast a link's points move, at most, as the motors turn, m/s.
  double CalcTurningSpeed(int link) const {
    double speed = 0.0;
    for (const int k : simulation_.movers_[static_cast<size_t>(link)]) {
      speed += std::abs(speeds_[static_cast<size_t>(k)]) *
               hand_.motion_bound(link, joints_[static_cast<size_t>(k)].joint);
    }
    return speed;
  }

  // For one step. @returns whether any still turns.
  bool TurnMotors() {
    bool turns = false;
    bool before_blocked = false;
    for (size_t k = 0; k < joints_.size(); ++k) {
      const auto& joint = joints_[k];
      const auto i = static_cast<Eigen::Index>(k);
      if (joint.is_first) before_blocked = false;
      const double most_lead = joint.closing_torque / joint.stiffness;
      const double q = state_.q[joint.joint];
      double& motor = state_.motors[i];
      speeds_[k] = 0.0;
      if ((joint.sign * (motor - q) >= 0.99 * most_lead &&
           joint.sign * state_.velocity[6 + i] <
               kStalled * joint.sign * joint.speed) ||
          joint.sign * (motor - joint.limit) >= 0.0) {
        blocked_[k] = true;
      }
      if (!blocked_[k]) {
        turns = true;
        speeds_[k] = before_blocked ? joint.released_speed : joint.speed;
        motor =
            joint.sign *
            std::min({joint.sign * (motor + speeds_[k] * parameters_.time_step),
                      joint.sign * joint.limit, joint.sign * q + most_lead});
      }
      before_blocked = before_blocked || blocked_[k];
    }
    return turns;
  }

  // Links and object have moved on relative to each other.
  void FindTouches() {
    CalcLinkPoses(hand_.model(), state_.q, X_WL_);
    const RigidTransform X_OW = CalcObjectPose().Inverse();
    const double object_speed = CalcObjectSpeed();
    touches_.clear();
    contacts_.clear();
    for (int link = 0; link < hand_.model().num_links(); ++link) {
      RigidTransform& X_WL = X_WL_[static_cast<size_t>(link)];
      X_WL = X_WH_ * X_WL;
      if (!hand_.link(link)) continue;
      const double near =
          std::min(simulation_.near_,
                   kSkin + kMargin * parameters_.time_step *
                               (object_speed + CalcTurningSpeed(link)));
      const size_t begin = touches_.size();
      finder_.Visit(link, X_OW * X_WL, near,
                    [&](const Eigen::Vector3d& p_L, double distance,
                        const Eigen::Vector3d& nhat_O) {
                      touches_.push_back({distance, state_.R_WO * nhat_O,
                                          X_WL * p_L - state_.p_WC});
                    });
      if (touches_.size() > begin) {
        contacts_.push_back({link, begin, touches_.size()});
      }
    }
    for (size_t k = 0; k < joints_.size(); ++k) {
      const HandJoint& joint =
          hand_.model().joints()[static_cast<size_t>(joints_[k].joint)];
      const RigidTransform& X_WJ = X_WL_[static_cast<size_t>(joint.child_link)];
      const Eigen::Vector3d axis_W = X_WJ.rotation * joint.axis_J;
      if (joint.type == JointType::kPrismatic) {
        twists_[k] << axis_W, Eigen::Vector3d::Zero();
      } else {
        twists_[k] << axis_W.cross(state_.p_WC - X_WJ.translation), axis_W;
      }
    }
  }

  // Implicit Euler with contacts that are springs along their normals and
  // dashpots, as stiff as Coulomb's law allows, across.
  void Step(const Eigen::Vector3d& push) {
    FindTouches();
    const double dt = parameters_.time_step;
    free_.SetZero();
    free_.body().topLeftCorner<3, 3>().diagonal().setConstant(parameters_.mass /
                                                              dt);
    free_.body().bottomRightCorner<3, 3>() =
        parameters_.mass / dt * state_.R_WO * solid_.mass().gyration *
        state_.R_WO.transpose();
    free_.body_right() = free_.body() * state_.velocity.head<6>();
    free_.body_right().head<3>() += push;
    for (size_t k = 0; k < joints_.size(); ++k) {
      const auto& joint = joints_[k];
      const auto i = static_cast<int>(k);
      const double lead =
          state_.motors[static_cast<Eigen::Index>(k)] - state_.q[joint.joint];
      double& weight = free_.joint(i, i);
      double& right = free_.right(i);
      weight = joint.armature / dt + joint.damping;
      right = joint.armature / dt * state_.velocity[6 + i];
      if (std::abs(joint.stiffness * lead) < joint.holding_torque) {
        weight += joint.stiffness * dt;
        right += joint.stiffness * lead;
      } else {
        right += std::copysign(joint.holding_torque, lead);
      }
    }
    for (int pass = 0; pass < kPasses; ++pass) {
      touching_ = free_;
      for (const Contacts& contacts : contacts_) AddContacts(contacts);
      touching_.Solve(state_.velocity);
    }
    Move();
  }

  // What a link's touches press and rub, given the speeds of the pass before.
  void AddContacts(const Contacts& contacts) {
    const Eigen::VectorXd& x = state_.velocity;
    const double dt = parameters_.time_step;
    const double stiffness = parameters_.contact_stiffness;
    const std::vector<int>& movers =
        simulation_.movers_[static_cast<size_t>(contacts.link)];
    // Of the link against the object.
    Twist twist = -x.head<6>();
    for (const int k : movers) {
      twist += x[6 + k] * twists_[static_cast<size_t>(k)];
    }
    // The wrench on the object is M twist - w. What rubs adds as mass does, by
    // its sum and its first and second moments.
    Matrix6 M = Matrix6::Zero();
    Twist w = Twist::Zero();
    double sum = 0.0;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    for (size_t i = contacts.begin; i < contacts.end; ++i) {
      const Touch& touch = touches_[i];
      const Eigen::Vector3d v =
          twist.head<3>() + twist.tail<3>().cross(touch.arm);
      const double approach = touch.nhat.dot(v);
      const double normal_force = -stiffness * (touch.distance + dt * approach);
      if (normal_force <= 0.0) continue;
      const double slip = (v - approach * touch.nhat).norm();
      const double rub =
          friction_ * normal_force / std::max(slip, kStickingSpeed);
      // The force on the object is (stiffness dt - rub) n n.v + rub v - f n.
      Twist line;
      line << touch.nhat, touch.arm.cross(touch.nhat);
      M.noalias() += ((stiffness * dt - rub) * line) * line.transpose();
      w -= (stiffness * touch.distance) * line;
      sum += rub;
      first += rub * touch.arm;
      second.noalias() += (rub * touch.arm) * touch.arm.transpose();
    }
    M.topLeftCorner<3, 3>().diagonal().array() += sum;
    M.bottomLeftCorner<3, 3>() += MakeCross(first);
    M.topRightCorner<3, 3>() -= MakeCross(first);
    M.bottomRightCorner<3, 3>() -= second;
    M.bottomRightCorner<3, 3>().diagonal().array() += second.trace();
    touching_.body() += M;
    touching_.body_right() -= w;
    for (const int k : movers) {
      const Twist& of_k = twists_[static_cast<size_t>(k)];
      const Twist M_k = M * of_k;
      touching_.coupling(k) -= M_k;
      touching_.right(k) += w.dot(of_k);
      for (const int other : movers) {
        if (other > k) break;
        touching_.joint(k, other) +=
            M_k.dot(twists_[static_cast<size_t>(other)]);
      }
    }
  }

  void Move() {
    const double dt = parameters_.time_step;
    for (size_t k = 0; k < joints_.size(); ++k) {
      const int j = joints_[k].joint;
      double& speed = state_.velocity[6 + static_cast<Eigen::Index>(k)];
      const double before = state_.q[j];
      const HandJoint& joint = hand_.model().joints()[static_cast<size_t>(j)];
      state_.q[j] = std::clamp(before + dt * speed, joint.lower, joint.upper);
      if (state_.q[j] != before + dt * speed) speed = 0.0;
      for (int link = 0; link < hand_.model().num_links(); ++link) {
        finder_.Move(
            link, std::abs(state_.q[j] - before) * hand_.motion_bound(link, j));
      }
    }
    const Eigen::Vector3d w = dt * state_.velocity.segment<3>(3);
    const double angle = w.norm();
    if (angle > 0.0) {
      state_.R_WO =
          Eigen::AngleAxisd(angle, w / angle).toRotationMatrix() * state_.R_WO;
    }
    const Eigen::Vector3d step = dt * state_.velocity.head<3>();
    state_.p_WC += step;
    const double moved =
        step.norm() + angle * (solid_.mass().max_radius + finder_.reach());
    for (int link = 0; link < hand_.model().num_links(); ++link) {
      finder_.Move(link, moved);
    }
  }

  // Of the object's points, at most, m/s.
  double CalcObjectSpeed() const {
    return state_.velocity.head<3>().norm() +
           solid_.mass().max_radius * state_.velocity.segment<3>(3).norm();
  }

  bool IsCalm() const { return CalcObjectSpeed() < kCalmSpeed; }

  // How far the object is from where it was, and whether that is too far.
  bool IsLost(const State& start, double& shift, double& turn) const {
    const double shift_now = (state_.p_WC - start.p_WC).norm();
    const double turn_now =
        CalcRotationAngle(start.R_WO.transpose() * state_.R_WO);
    shift = std::max(shift, shift_now);
    turn = std::max(turn, turn_now);
    // What is no number any more is lost, too.
    return !(shift_now < parameters_.max_shift &&
             turn_now < parameters_.max_turn);
  }

  bool Withstands(Push which) {
    if (parameters_.push == 0.0 || which == Push::kNone) return true;
    const State settled = state_;
    const TouchFinder seen = finder_;
    for (int i = 0; i < kNumPushes; ++i) {
      if (which != Push::kAll && which != static_cast<Push>(i)) continue;
      state_ = settled;
      finder_ = seen;
      Eigen::Vector3d push = Eigen::Vector3d::Zero();
      push[i / 2] = i % 2 == 0 ? parameters_.push : -parameters_.push;
      double shift = 0.0;
      double turn = 0.0;
      double rest = 0.0;
      for (double t = 0.0;
           t < parameters_.push_seconds && rest < parameters_.settle_seconds;
           t += parameters_.time_step) {
        Step(std::min(1.0, t / kRampSeconds) * push);
        if (IsLost(settled, shift, turn)) return false;
        rest =
            t < kRampSeconds || !IsCalm() ? 0.0 : rest + parameters_.time_step;
      }
    }
    return true;
  }

  const ClosingSimulation& simulation_;
  const HoldParameters& parameters_;
  const HandShape& hand_;
  const Solid& solid_;
  const std::vector<ClosingSimulation::ClosingJoint>& joints_;
  const double friction_;
  const RigidTransform X_WH_;
  State state_;
  std::vector<bool> blocked_;
  std::vector<double> speeds_;  // Of the motors, 0 when blocked.
  TouchFinder finder_;
  std::vector<Touch> touches_;
  std::vector<Contacts> contacts_;
  std::vector<RigidTransform> X_WL_;
  std::vector<Twist> twists_;  // Of the closing joints, about p_WC.
  ArrowSystem free_;           // Of a step without touches, and …
  ArrowSystem touching_;       // … with them.
};

ClosingOutcome ClosingSimulation::Run(const RigidTransform& X_OH,
                                      const Eigen::VectorXd& q_open,
                                      double friction, Push push) const {
  return ClosingRun(*this, X_OH, q_open, friction).Run(push);
}

}  // namespace graspdb
