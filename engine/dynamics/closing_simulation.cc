#include "engine/dynamics/closing_simulation.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace graspdb {
namespace {

// What a motor weighs behind its gear, kg m², and how fast its swings die.
constexpr double kArmature = 0.0007;
constexpr double kDampingSeconds = 0.002;  // Damping over stiffness.
// A slide is as stiff at the tip as a finger of a decimetre, and as fast.
constexpr double kSlideLength = 0.1;  // m per rad.
constexpr double kLeastLever = 0.01;  // Of a link without a shape, m.
// Probes of the links that may touch the surface within a step are those as
// near as a finger moves in it, and a little farther; those within this of them
// are looked at until something has moved so far, m.
constexpr double kMargin = 1.2;
constexpr double kWatched = 0.006;
// Below this speed, m/s, what rubs is taken to stick.
constexpr double kStickingSpeed = 1e-4;
// Passes in which the contacts of a step find out whether they press and slip.
constexpr int kPasses = 2;
// A joint slower than this share of its motor is blocked.
constexpr double kStalled = 0.1;
// An object all of whose points are slower than this is at rest, m/s.
constexpr double kCalmSpeed = 0.005;
// The fingers are brought so near before anything is simulated, m.
constexpr double kLeadIn = 0.002;
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
      near_ =
          std::max(near_, kMargin * parameters.time_step * one.speed * lever);
      joints_.push_back(one);
    }
  }
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
        size_(6 + static_cast<Eigen::Index>(joints_.size())),
        friction_(friction),
        X_WH_(X_WH) {
    state_.q = q;
    state_.p_WC = solid_.mass().p_McCM;
    state_.velocity = Eigen::VectorXd::Zero(size_);
    blocked_.assign(joints_.size(), false);
    watches_.resize(static_cast<size_t>(hand_.model().num_links()));
  }

  ClosingOutcome Run(Push push) {
    ClosingOutcome outcome;
    LeadIn();
    const State start = state_;
    double rest = 0.0;
    for (double t = 0.0;
         t < kLongestClosing && rest < parameters_.settle_seconds;
         t += parameters_.time_step) {
      const bool turns = TurnMotors();
      Step(Eigen::Vector3d::Zero());
      if (IsLost(start, outcome.shift, outcome.turn)) return outcome;
      rest = turns || !IsCalm() ? 0.0 : rest + parameters_.time_step;
    }
    outcome.settled = rest >= parameters_.settle_seconds && !touches_.empty();
    outcome.held = outcome.settled && Withstands(push);
    return outcome;
  }

 private:
  struct State {
    Eigen::VectorXd q;       // All joints …
    Eigen::VectorXd motors;  // … and where the closing ones' motors are.
    Eigen::Matrix3d R_WO{Eigen::Matrix3d::Identity()};
    Eigen::Vector3d p_WC;      // The object's mass centre.
    Eigen::VectorXd velocity;  // The object's v and w, then closing joints.
  };

  // A probe of a link that is, or will be, in contact.
  struct Touch {
    int link;
    double distance;       // Negative inside.
    Eigen::Vector3d nhat;  // Out of the object.
    Eigen::Vector3d arm;   // From the object's mass centre.
    Eigen::Vector3d p_W;
  };

  struct Probe {
    Eigen::Vector3d p_L;
    double wake;  // The link's travel at which it may be near.
  };

  // The probes of a link that may come near, up to some travel of the link: how
  // far any of its points has moved relative to the object, at most, m.
  struct Watch {
    std::vector<Probe> probes;
    double travel{0.0};
    double until{0.0};
  };

  RigidTransform CalcObjectPose() const {
    return {state_.R_WO, state_.p_WC - state_.R_WO * solid_.mass().p_McCM};
  }

  // Before a finger has come near the object nothing happens.
  void LeadIn() {
    double closing_speed = 0.0;
    for (int link = 0; link < hand_.model().num_links(); ++link) {
      double speed = 0.0;
      for (const int k : simulation_.movers_[static_cast<size_t>(link)]) {
        const auto& joint = joints_[static_cast<size_t>(k)];
        speed += joint.speed * hand_.motion_bound(link, joint.joint);
      }
      closing_speed = std::max(closing_speed, speed);
    }
    const RigidTransform X_OH = CalcObjectPose().Inverse() * X_WH_;
    for (int round = 0; round < 20 && closing_speed > 0.0; ++round) {
      const auto X_HL = CalcLinkPoses(hand_.model(), state_.q);
      double gap = 1e300;
      for (int link = 0; link < hand_.model().num_links(); ++link) {
        if (!hand_.link(link) ||
            simulation_.movers_[static_cast<size_t>(link)].empty()) {
          continue;
        }
        gap = std::min(gap, EstimateGap(*hand_.link(link),
                                        X_OH * X_HL[static_cast<size_t>(link)],
                                        solid_, kLeadIn));
      }
      if (gap <= kLeadIn) break;
      const double seconds = (gap - 0.5 * kLeadIn) / closing_speed;
      for (const auto& joint : joints_) {
        double& q = state_.q[joint.joint];
        q = std::min(q + seconds * joint.speed, Upper(joint.joint));
      }
    }
    state_.motors.resize(static_cast<Eigen::Index>(joints_.size()));
    for (size_t k = 0; k < joints_.size(); ++k) {
      state_.motors[static_cast<Eigen::Index>(k)] = state_.q[joints_[k].joint];
    }
  }

  double Upper(int joint) const {
    return hand_.model().joints()[static_cast<size_t>(joint)].upper;
  }
  double Lower(int joint) const {
    return hand_.model().joints()[static_cast<size_t>(joint)].lower;
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
      if ((motor - q >= 0.99 * most_lead &&
           state_.velocity[6 + i] < kStalled * joint.speed) ||
          motor >= Upper(joint.joint)) {
        blocked_[k] = true;
      }
      if (!blocked_[k]) {
        turns = true;
        const double speed =
            before_blocked ? joint.released_speed : joint.speed;
        motor = std::min({motor + speed * parameters_.time_step,
                          Upper(joint.joint), q + most_lead});
      }
      before_blocked = before_blocked || blocked_[k];
    }
    return turns;
  }

  // Links and object have moved on relative to each other. A probe needs to be
  // looked at again only when its link may have come as near as it was seen to
  // be away.
  void FindTouches() {
    X_WL_ = CalcLinkPoses(hand_.model(), state_.q);
    const RigidTransform X_OW = CalcObjectPose().Inverse();
    const DistanceField& field = solid_.field();
    const double near = simulation_.near_;
    touches_.clear();
    for (int link = 0; link < hand_.model().num_links(); ++link) {
      const auto l = static_cast<size_t>(link);
      X_WL_[l] = X_WH_ * X_WL_[l];
      if (!hand_.link(link)) continue;
      const RigidTransform X_OL = X_OW * X_WL_[l];
      Watch& watch = watches_[l];
      if (watch.travel >= watch.until) {
        watch.until = watch.travel + kWatched;
        watch.probes.clear();
        hand_.link(link)->tree.VisitNear(
            [&](const Eigen::Vector3d& p_L) { return field.Calc(X_OL * p_L); },
            kWatched + near,
            [&](const Eigen::Vector3d& p_L) {
              watch.probes.push_back({p_L, watch.travel});
            });
      }
      for (Probe& probe : watch.probes) {
        if (watch.travel < probe.wake) continue;
        const Eigen::Vector3d p_O = X_OL * probe.p_L;
        const double distance = field.Calc(p_O);
        if (distance > near) {
          probe.wake = watch.travel + distance - near;
          continue;
        }
        const Eigen::Vector3d gradient = field.CalcGradient(p_O);
        const double norm = gradient.norm();
        if (!(norm > 0.0)) continue;
        const Eigen::Vector3d p_W = X_WL_[l] * probe.p_L;
        touches_.push_back({link, distance, state_.R_WO * (gradient / norm),
                            p_W - state_.p_WC, p_W});
      }
    }
    for (size_t k = 0; k < joints_.size(); ++k) {
      const HandJoint& joint =
          hand_.model().joints()[static_cast<size_t>(joints_[k].joint)];
      const RigidTransform& X_WJ = X_WL_[static_cast<size_t>(joint.child_link)];
      slides_[k] = joint.type == JointType::kPrismatic;
      p_WJ_[k] = X_WJ.translation;
      axis_W_[k] = X_WJ.rotation * joint.axis_J;
    }
  }

  // How fast a touch's point on the link moves per unit of joint k.
  Eigen::Vector3d CalcColumn(const Touch& touch, size_t k) const {
    if (slides_[k]) return axis_W_[k];
    return axis_W_[k].cross(touch.p_W - p_WJ_[k]);
  }

  // Implicit Euler with contacts that are springs along their normals and
  // dashpots, as stiff as Coulomb's law allows, across.
  void Step(const Eigen::Vector3d& push) {
    p_WJ_.resize(joints_.size());
    axis_W_.resize(joints_.size());
    slides_.resize(joints_.size());
    FindTouches();
    const double dt = parameters_.time_step;
    Eigen::MatrixXd& A0 = A0_;
    Eigen::VectorXd& b0 = b0_;
    A0.setZero(size_, size_);
    b0.setZero(size_);
    A0.topLeftCorner<3, 3>().diagonal().setConstant(parameters_.mass / dt);
    A0.block<3, 3>(3, 3) = parameters_.mass / dt * state_.R_WO *
                           solid_.mass().gyration * state_.R_WO.transpose();
    b0.head<6>() = A0.topLeftCorner<6, 6>() * state_.velocity.head<6>();
    b0.head<3>() += push;
    for (size_t k = 0; k < joints_.size(); ++k) {
      const auto& joint = joints_[k];
      const auto i = 6 + static_cast<Eigen::Index>(k);
      const double lead =
          state_.motors[static_cast<Eigen::Index>(k)] - state_.q[joint.joint];
      A0(i, i) = joint.armature / dt + joint.damping;
      b0[i] = joint.armature / dt * state_.velocity[i];
      if (std::abs(joint.stiffness * lead) < joint.holding_torque) {
        A0(i, i) += joint.stiffness * dt;
        b0[i] += joint.stiffness * lead;
      } else {
        b0[i] += std::copysign(joint.holding_torque, lead);
      }
    }
    Eigen::VectorXd& x = x_;
    x = state_.velocity;
    for (int pass = 0; pass < kPasses; ++pass) {
      A_ = A0;
      b_ = b0;
      for (const Touch& touch : touches_) AddTouch(touch, x);
      solver_.compute(A_);
      x = solver_.solve(b_);
    }
    state_.velocity = x;
    Move();
  }

  // What a touch presses and rubs, given the speeds x of the pass before, to
  // the lower half of A and to b.
  void AddTouch(const Touch& touch, const Eigen::VectorXd& x) {
    const double dt = parameters_.time_step;
    const std::vector<int>& movers =
        simulation_.movers_[static_cast<size_t>(touch.link)];
    Eigen::Vector3d v = -x.head<3>() - x.segment<3>(3).cross(touch.arm);
    for (const int k : movers) {
      v += x[6 + k] * CalcColumn(touch, static_cast<size_t>(k));
    }
    const double stiffness = parameters_.contact_stiffness;
    const double approach = touch.nhat.dot(v);
    const double normal_force = -stiffness * (touch.distance + dt * approach);
    if (normal_force <= 0.0) return;
    const double slip = (v - approach * touch.nhat).norm();
    const double rub =
        friction_ * normal_force / std::max(slip, kStickingSpeed);
    // Force on the object = f0 n + W v.
    Eigen::Matrix3d W =
        (stiffness * dt - rub) * touch.nhat * touch.nhat.transpose();
    W.diagonal().array() += rub;
    const double f0 = -stiffness * touch.distance;
    const Eigen::Matrix3d arm = MakeCross(touch.arm);
    const Eigen::Matrix3d W_arm = W * arm;
    A_.topLeftCorner<3, 3>() += W;
    A_.block<3, 3>(3, 0) -= W_arm.transpose();
    A_.block<3, 3>(3, 3) -= arm * W_arm;
    b_.head<3>() -= f0 * touch.nhat;
    b_.segment<3>(3) -= f0 * touch.arm.cross(touch.nhat);
    for (const int k : movers) {
      const Eigen::Vector3d column = CalcColumn(touch, static_cast<size_t>(k));
      const Eigen::Vector3d W_column = W * column;
      A_.block<1, 3>(6 + k, 0) -= W_column.transpose();
      A_.block<1, 3>(6 + k, 3) += column.transpose() * W_arm;
      b_[6 + k] += f0 * column.dot(touch.nhat);
      for (const int other : movers) {
        if (other > k) break;
        A_(6 + k, 6 + other) +=
            W_column.dot(CalcColumn(touch, static_cast<size_t>(other)));
      }
    }
  }

  void Move() {
    const double dt = parameters_.time_step;
    for (size_t k = 0; k < joints_.size(); ++k) {
      const int j = joints_[k].joint;
      double& speed = state_.velocity[6 + static_cast<Eigen::Index>(k)];
      const double before = state_.q[j];
      state_.q[j] = std::clamp(before + dt * speed, Lower(j), Upper(j));
      if (state_.q[j] != before + dt * speed) speed = 0.0;
      for (int link = 0; link < hand_.model().num_links(); ++link) {
        watches_[static_cast<size_t>(link)].travel +=
            std::abs(state_.q[j] - before) * hand_.motion_bound(link, j);
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
    // As far as the object reaches: what is watched is that near to it.
    const double moved = step.norm() + angle * (solid_.mass().max_radius +
                                                kWatched + simulation_.near_);
    for (Watch& watch : watches_) watch.travel += moved;
  }

  bool IsCalm() const {
    return state_.velocity.head<3>().norm() +
               solid_.mass().max_radius * state_.velocity.segment<3>(3).norm() <
           kCalmSpeed;
  }

  // How far the object is from where it was, and whether that is too far.
  bool IsLost(const State& start, double& shift, double& turn) const {
    shift = std::max(shift, (state_.p_WC - start.p_WC).norm());
    turn =
        std::max(turn, CalcRotationAngle(start.R_WO.transpose() * state_.R_WO));
    return !(shift < parameters_.max_shift && turn < parameters_.max_turn);
  }

  bool Withstands(Push which) {
    if (parameters_.push == 0.0 || which == Push::kNone) return true;
    const State settled = state_;
    for (int i = 0; i < 6; ++i) {
      if (which != Push::kAll && which != static_cast<Push>(i)) continue;
      state_ = settled;
      for (Watch& watch : watches_) watch.until = 0.0;
      Eigen::Vector3d push = Eigen::Vector3d::Zero();
      push[i / 2] = i % 2 == 0 ? parameters_.push : -parameters_.push;
      double shift = 0.0;
      double turn = 0.0;
      for (double t = 0.0; t < parameters_.push_seconds;
           t += parameters_.time_step) {
        Step(std::min(1.0, t / kRampSeconds) * push);
        if (IsLost(settled, shift, turn)) return false;
      }
    }
    return true;
  }

  const ClosingSimulation& simulation_;
  const HoldParameters& parameters_;
  const HandShape& hand_;
  const Solid& solid_;
  const std::vector<ClosingSimulation::ClosingJoint>& joints_;
  const Eigen::Index size_;
  const double friction_;
  const RigidTransform X_WH_;
  State state_;
  std::vector<bool> blocked_;
  std::vector<Watch> watches_;
  std::vector<Touch> touches_;
  std::vector<RigidTransform> X_WL_;
  std::vector<Eigen::Vector3d> p_WJ_, axis_W_;
  std::vector<char> slides_;
  Eigen::MatrixXd A0_, A_;
  Eigen::VectorXd b0_, b_, x_;
  Eigen::LLT<Eigen::MatrixXd> solver_;  // Reads the lower half.
};

ClosingOutcome ClosingSimulation::Run(const RigidTransform& X_OH,
                                      const Eigen::VectorXd& q_open,
                                      double friction, Push push) const {
  return ClosingRun(*this, X_OH, q_open, friction).Run(push);
}

}  // namespace graspdb
