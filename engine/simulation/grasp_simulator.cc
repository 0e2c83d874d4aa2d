#include "engine/simulation/grasp_simulator.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "engine/base/contract.h"
#include "engine/simulation/convex_pieces.h"

namespace graspdb {
namespace {

constexpr double kLongestClosing = 6.0;  // s.
// Of a link about its mass centre, kg m² per kg: a few centimetres of metal.
constexpr double kLinkGyration = 4e-4;
constexpr double kArmature = 0.0005;  // Of a motor behind its gear, kg m².
constexpr double kDampingSeconds = 0.002;  // Damping over stiffness.
// A joint slower than this share of its motor is blocked.
constexpr double kStalled = 0.1;
constexpr double kSlideShare = 0.1;   // Of a motor's speed, m per rad.
constexpr double kLeastLever = 0.01;  // Of a link without a shape, m.
// Of one moment; some tens are usual. MuJoCo keeps the square of the latter and
// copies it with each state.
constexpr int kMostContacts = 400;
constexpr int kMostConstraints = 4 * kMostContacts;
// What holds a joint that does not close, in tip forces.
constexpr double kHoldingFactor = 5.0;

struct ModelDeleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct DataDeleter {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using ModelPointer = std::unique_ptr<mjModel, ModelDeleter>;
using DataPointer = std::unique_ptr<mjData, DataDeleter>;

std::string Format(const Eigen::Vector3d& v) {
  return fmt::format("{} {} {}", v.x(), v.y(), v.z());
}

std::string FormatPose(const RigidTransform& X) {
  const Eigen::Quaterniond q(X.rotation);
  return fmt::format("pos=\"{}\" quat=\"{} {} {} {}\"", Format(X.translation),
                     q.w(), q.x(), q.y(), q.z());
}

// From a joint's axis to the farthest point of what it moves: m.
double CalcLever(const HandModel& hand, int joint) {
  const auto X_HL =
      CalcLinkPoses(hand, Eigen::VectorXd::Zero(hand.num_joints()));
  const HandJoint& mover = hand.joints()[static_cast<size_t>(joint)];
  std::vector<bool> moved(static_cast<size_t>(hand.num_links()), false);
  double lever = kLeastLever;
  for (int i = mover.child_link; i < hand.num_links(); ++i) {
    const HandLink& link = hand.links()[static_cast<size_t>(i)];
    moved[static_cast<size_t>(i)] =
        i == mover.child_link ||
        (link.parent >= 0 && moved[static_cast<size_t>(link.parent)]);
    if (!moved[static_cast<size_t>(i)]) continue;
    const RigidTransform X_JL =
        X_HL[static_cast<size_t>(mover.child_link)].Inverse() *
        X_HL[static_cast<size_t>(i)];
    for (const TriangleMesh& piece : link.pieces_L) {
      for (const Eigen::Vector3d& p_L : piece.vertices()) {
        lever = std::max(lever, mover.axis_J.cross(X_JL * p_L).norm());
      }
    }
  }
  return lever;
}

// The scene as MuJoCo's XML: the hand's base, which is placed for each grasp
// and then stands still, and the object, which is free.
class SceneWriter {
 public:
  SceneWriter(const HandModel& hand, const PushTest& test)
      : hand_(hand), test_(test) {}

  std::string Write(const TriangleMesh& mesh_O) {
    WriteObject(mesh_O);
    WriteHand();
    return fmt::format(
        "<mujoco><compiler angle=\"radian\"/>"
        "<size njmax=\"{}\" nconmax=\"{}\" nstack=\"1000000\"/>"
        "<option timestep=\"{}\" gravity=\"0 0 0\" cone=\"elliptic\""
        " impratio=\"10\" solver=\"Newton\" iterations=\"60\""
        " noslip_iterations=\"8\"><flag multiccd=\"enable\"/></option>"
        "<default><geom condim=\"4\" friction=\"{} {} 0.0001\""
        " solref=\"0.004 1\" solimp=\"0.95 0.99 0.0005\"/></default>"
        "<asset>{}</asset><worldbody>{}{}</worldbody>"
        "<actuator>{}</actuator><equality><weld body1=\"object\""
        " solref=\"0.004 1\" solimp=\"0.99 0.999 0.0001\"/></equality>"
        "</mujoco>",
        kMostConstraints, kMostContacts, test_.time_step, test_.friction,
        test_.torsion, assets_, hand_bodies_, object_body_, actuators_);
  }

 private:
  // The object meets the hand, and nothing else meets anything.
  std::string AddMesh(const std::vector<Eigen::Vector3d>& points,
                      bool of_object) {
    const std::string name = fmt::format("m{}", num_meshes_++);
    assets_ += fmt::format("<mesh name=\"{}\" vertex=\"", name);
    for (const Eigen::Vector3d& p : points) assets_ += Format(p) + " ";
    assets_ += "\"/>";
    return fmt::format(
        "<geom type=\"mesh\" mesh=\"{}\" mass=\"0\" contype=\"{}\""
        " conaffinity=\"{}\"/>",
        name, of_object ? 1 : 2, of_object ? 2 : 1);
  }

  void WriteObject(const TriangleMesh& mesh_O) {
    const MassProperties properties = CalcMassProperties(mesh_O);
    const Eigen::Matrix3d I = test_.mass * properties.gyration;
    object_body_ = fmt::format(
        "<body name=\"object\"><freejoint/><inertial pos=\"{}\""
        " mass=\"{}\" fullinertia=\"{} {} {} {} {} {}\"/>",
        Format(properties.p_McCM), test_.mass, I(0, 0), I(1, 1), I(2, 2),
        I(0, 1), I(0, 2), I(1, 2));
    for (const auto& piece : MakeConvexPieces(mesh_O)) {
      object_body_ += AddMesh(piece, true);
    }
    object_body_ += "</body>";
  }

  void WriteHand() {
    hand_bodies_ = "<body name=\"base\">" + WriteInertial(hand_.links()[0]);
    for (const TriangleMesh& piece : hand_.links()[0].pieces_L) {
      hand_bodies_ += AddMesh(piece.vertices(), false);
    }
    hand_bodies_ += WriteChildren(0) + "</body>";
  }

  static std::string WriteInertial(const HandLink& link) {
    const double mass = std::max(link.mass, 0.001);
    return fmt::format(
        "<inertial pos=\"{}\" mass=\"{}\" diaginertia=\"{} {} {}\"/>",
        Format(link.p_LcCM), mass, mass * kLinkGyration, mass * kLinkGyration,
        mass * kLinkGyration);
  }

  std::string WriteChildren(int parent) {
    std::string bodies;
    for (int i = 1; i < hand_.num_links(); ++i) {
      const HandLink& link = hand_.links()[static_cast<size_t>(i)];
      if (link.parent != parent) continue;
      const HandJoint& joint = hand_.joints()[static_cast<size_t>(link.joint)];
      const bool slides = joint.type == JointType::kPrismatic;
      bodies += fmt::format("<body {}>", FormatPose(joint.X_PJ));
      bodies += WriteInertial(link);
      const HandActuator& actuator =
          hand_.actuators()[static_cast<size_t>(joint.actuator)];
      const double lever = slides ? 1.0 : CalcLever(hand_, link.joint);
      const double limit = test_.holding_force * lever *
                           (actuator.closes ? 1.0 : kHoldingFactor);
      // A slide's is as stiff at the tip as a finger of a decimetre.
      const double stiffness = test_.stiffness * (slides ? 100.0 : 1.0);
      const double armature = kArmature * (slides ? 100.0 : 1.0);
      bodies += fmt::format(
          "<joint name=\"j{}\" type=\"{}\" axis=\"{}\" limited=\"true\""
          " range=\"{} {}\" armature=\"{}\" damping=\"{}\"/>",
          link.joint, slides ? "slide" : "hinge", Format(joint.axis_J),
          joint.lower, joint.upper, armature, kDampingSeconds * stiffness);
      actuators_ += fmt::format(
          "<position name=\"a{0}\" joint=\"j{0}\" kp=\"{1}\""
          " forcelimited=\"true\" forcerange=\"{2} {3}\"/>",
          link.joint, stiffness, -limit, limit);
      for (const TriangleMesh& piece : link.pieces_L) {
        bodies += AddMesh(piece.vertices(), false);
      }
      bodies += WriteChildren(i) + "</body>";
    }
    return bodies;
  }

  const HandModel& hand_;
  const PushTest& test_;
  int num_meshes_{0};
  std::string assets_;
  std::string object_body_;
  std::string hand_bodies_;
  std::string actuators_;
};

ModelPointer Compile(const std::string& xml) {
  // MuJoCo's own handlers write a file and end the program. Set once, for all.
  static const bool handled = [] {
    mju_user_warning = [](const char*) {};
    mju_user_error = [](const char* text) {
      throw std::runtime_error(std::string("MuJoCo: ") + text);
    };
    return true;
  }();
  GRASPDB_EXPECTS(handled);
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  constexpr char kName[] = "scene.xml";
  if (mj_makeEmptyFileVFS(files.get(), kName, static_cast<int>(xml.size())) !=
      0) {
    throw std::runtime_error("MuJoCo takes no scene of this size");
  }
  const int index = mj_findFileVFS(files.get(), kName);
  std::memcpy(files->filedata[index], xml.data(), xml.size());
  char error[500] = "";
  ModelPointer model(mj_loadXML(kName, files.get(), error, sizeof error));
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
  return model;
}

}  // namespace

double PhysicalVerdict::CalcScore() const {
  if (!settled || held.empty()) return 0.0;
  return static_cast<double>(std::count(held.begin(), held.end(), true)) /
         static_cast<double>(held.size());
}

struct GraspSimulator::Impl {
  Impl(std::shared_ptr<const HandModel> hand_in, const TriangleMesh& mesh_O,
       const PushTest& test_in)
      : hand(std::move(hand_in)),
        test(test_in),
        model(Compile(SceneWriter(*hand, test).Write(mesh_O))),
        data(mj_makeData(model.get())),
        settled(mj_makeData(model.get())),
        object(mj_name2id(model.get(), mjOBJ_BODY, "object")),
        base(mj_name2id(model.get(), mjOBJ_BODY, "base")) {
    for (int j = 0; j < hand->num_joints(); ++j) {
      const std::string number = std::to_string(j);
      const int joint =
          mj_name2id(model.get(), mjOBJ_JOINT, ("j" + number).c_str());
      joints.push_back(model->jnt_qposadr[joint]);
      speeds.push_back(model->jnt_dofadr[joint]);
      servos.push_back(
          mj_name2id(model.get(), mjOBJ_ACTUATOR, ("a" + number).c_str()));
      limits.push_back(model->actuator_forcerange[2 * servos.back() + 1]);
    }
  }

  // The hand's base stands still at X_OH, the object at the origin, at rest.
  void Place(const Grasp& grasp) {
    const RigidTransform& X_OH = grasp.configuration.X_OH;
    const Eigen::Quaterniond q(X_OH.rotation);
    std::copy_n(X_OH.translation.data(), 3, &model->body_pos[3 * base]);
    double* const quat = &model->body_quat[4 * base];
    quat[0] = q.w();
    quat[1] = q.x();
    quat[2] = q.y();
    quat[3] = q.z();
    mj_resetData(model.get(), data.get());
    model->eq_active[0] = test.fixed_while_closing ? 1 : 0;
    for (int j = 0; j < hand->num_joints(); ++j) {
      const bool closes =
          hand
              ->actuators()[static_cast<size_t>(
                  hand->joints()[static_cast<size_t>(j)].actuator)]
              .closes;
      const double q_j =
          closes ? grasp.q_pregrasp[j] : grasp.configuration.q[j];
      data->qpos[joints[static_cast<size_t>(j)]] = q_j;
      data->ctrl[servos[static_cast<size_t>(j)]] = q_j;
    }
    mj_forward(model.get(), data.get());
  }

  // Whether a joint has met its limit of torque or of motion.
  bool Blocked(int j) const {
    const auto i = static_cast<size_t>(j);
    const HandJoint& joint = hand->joints()[i];
    const double sign = joint.closing_sign();
    const double lead = sign * (data->ctrl[servos[i]] - data->qpos[joints[i]]);
    const bool stalls = lead >= 0.99 * FindMostLead(j) &&
                        sign * data->qvel[speeds[i]] <
                            kStalled * sign * joint.ratio * FindSpeed(joint);
    return stalls ||
           sign * (data->ctrl[servos[i]] - joint.closing_limit()) >= 0.0;
  }

  double FindSpeed(const HandJoint& joint) const {
    return test.closing_speed *
           (joint.type == JointType::kPrismatic ? kSlideShare : 1.0);
  }

  // How far a motor gets ahead of its joint while closing: by its force.
  double FindMostLead(int j) const {
    const auto i = static_cast<size_t>(j);
    const double kp = model->actuator_gainprm[mjNGAIN * servos[i]];
    return limits[i] * test.closing_force / test.holding_force / kp;
  }

  // Turns the motors for one step. @returns whether any still turns.
  bool Close(std::vector<bool>& blocked) {
    bool turns = false;
    for (const HandActuator& actuator : hand->actuators()) {
      if (!actuator.closes) continue;
      bool inner_blocked = false;
      for (const int j : actuator.joints) {
        const auto i = static_cast<size_t>(j);
        const HandJoint& joint = hand->joints()[i];
        blocked[i] = blocked[i] || Blocked(j);
        if (!blocked[i]) {
          turns = true;
          const double ratio = inner_blocked && joint.breakaway_ratio > 0.0
                                   ? joint.breakaway_ratio
                                   : joint.ratio;
          const double sign = joint.closing_sign();
          const double next =
              data->ctrl[servos[i]] + ratio * FindSpeed(joint) * test.time_step;
          data->ctrl[servos[i]] =
              sign * std::min({sign * next, sign * joint.closing_limit(),
                               sign * data->qpos[joints[i]] + FindMostLead(j)});
        }
        inner_blocked = inner_blocked || blocked[i];
      }
    }
    return turns;
  }

  Eigen::Vector3d CentreOf(const mjData& d) const {
    return Eigen::Map<const Eigen::Vector3d>(&d.xipos[3 * object]);
  }
  Eigen::Quaterniond TurnOf(const mjData& d) const {
    const double* q = &d.xquat[4 * object];
    return {q[0], q[1], q[2], q[3]};
  }

  // How far the object is from where it was, and whether that is too far.
  bool Lost(const Eigen::Vector3d& centre, const Eigen::Quaterniond& turn,
            double& shift, double& angle) const {
    shift = std::max(shift, (CentreOf(*data) - centre).norm());
    angle = std::max(angle, TurnOf(*data).angularDistance(turn));
    return BlownUp() || !(shift < test.max_shift && angle < test.max_turn);
  }

  void Step() {
    mj_step(model.get(), data.get());
    // MuJoCo would leave out what it has no room for.
    for (const int full : {mjWARN_CONTACTFULL, mjWARN_CNSTRFULL}) {
      if (data->warning[full].number > 0) {
        throw std::runtime_error("MuJoCo: too many contacts at once");
      }
    }
  }

  // MuJoCo starts anew from a state that has blown up: that is lost, too.
  bool BlownUp() const {
    for (const int bad : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC}) {
      if (data->warning[bad].number > 0) return true;
    }
    return false;
  }

  bool Settle(const Grasp& grasp, PhysicalVerdict& verdict) {
    Place(grasp);
    const Eigen::Vector3d centre = CentreOf(*data);
    const Eigen::Quaterniond turn = TurnOf(*data);
    std::vector<bool> blocked(joints.size(), false);
    double rest = 0.0;
    for (double t = 0.0; t < kLongestClosing && rest < test.settle_seconds;
         t += test.time_step) {
      if (!Close(blocked)) {
        rest += test.time_step;
        model->eq_active[0] = 0;  // From here on nothing else holds it.
      }
      Step();
      if (Lost(centre, turn, verdict.settle_shift, verdict.settle_turn)) {
        return false;
      }
    }
    mj_copyData(settled.get(), model.get(), data.get());
    return rest >= test.settle_seconds;
  }

  // Each push from the settled state, until it is lost.
  void PushApart(PhysicalVerdict& verdict) {
    for (const Eigen::Vector3d& direction : test.pushes) {
      mj_copyData(data.get(), model.get(), settled.get());
      const Eigen::Vector3d centre = CentreOf(*data);
      const Eigen::Quaterniond turn = TurnOf(*data);
      double shift = 0.0;
      double angle = 0.0;
      bool held = true;
      Push(direction, [&] {
        held = !Lost(centre, turn, shift, angle);
        return held;
      });
      verdict.shift.push_back(shift);
      verdict.turn.push_back(angle);
      verdict.held.push_back(held);
    }
  }

  // One push after another; what counts is where the object is at last.
  void PushInTurn(PhysicalVerdict& verdict) {
    mj_copyData(data.get(), model.get(), settled.get());
    const Eigen::Vector3d centre = CentreOf(*data);
    const Eigen::Quaterniond turn = TurnOf(*data);
    for (const Eigen::Vector3d& direction : test.pushes) {
      Push(direction, [&] { return !BlownUp(); });
    }
    verdict.shift.push_back((CentreOf(*data) - centre).norm());
    verdict.turn.push_back(TurnOf(*data).angularDistance(turn));
    verdict.held.push_back(verdict.shift.back() < test.max_shift && !BlownUp());
  }

  // @param goes_on  Asked after each step.
  template <class F>
  void Push(const Eigen::Vector3d& direction, F&& goes_on) {
    const double end = test.ramp_seconds + test.push_seconds;
    for (double t = 0.0; t < end; t += test.time_step) {
      const Eigen::Vector3d force =
          std::min(1.0, t / test.ramp_seconds) * test.force * direction;
      std::copy_n(force.data(), 3, &data->xfrc_applied[6 * object]);
      Step();
      if (!goes_on()) return;
    }
  }

  std::shared_ptr<const HandModel> hand;
  PushTest test;
  ModelPointer model;
  DataPointer data;
  DataPointer settled;
  int object;
  int base;
  std::vector<int> joints;  // Where each joint's position is in qpos.
  std::vector<int> speeds;  // The same of its speed in qvel.
  std::vector<int> servos;
  std::vector<double> limits;  // Of each servo, N m or N, while holding.
};

GraspSimulator::GraspSimulator(std::shared_ptr<const HandModel> hand,
                               const TriangleMesh& mesh_O, const PushTest& test)
    : impl_(std::make_unique<Impl>(std::move(hand), mesh_O, test)) {}
GraspSimulator::~GraspSimulator() = default;
GraspSimulator::GraspSimulator(GraspSimulator&&) noexcept = default;
GraspSimulator& GraspSimulator::operator=(GraspSimulator&&) noexcept = default;

PhysicalVerdict GraspSimulator::Judge(const Grasp& grasp) {
  PhysicalVerdict verdict;
  verdict.settled = impl_->Settle(grasp, verdict);
  if (!verdict.settled) return verdict;
  if (impl_->test.one_episode) {
    impl_->PushInTurn(verdict);
  } else {
    impl_->PushApart(verdict);
  }
  return verdict;
}

PushTest MakeNetDisplacementTest() {
  PushTest test;
  test.name =
      "net displacement after 1 N along +x +y +z -x -y -z in one episode, "
      "0.1 kg, friction 3, < 2 cm";
  test.pushes = {Eigen::Vector3d::UnitX(),  Eigen::Vector3d::UnitY(),
                 Eigen::Vector3d::UnitZ(),  -Eigen::Vector3d::UnitX(),
                 -Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitZ()};
  test.one_episode = true;
  test.friction = 3.0;
  return test;
}

PushTest MakeLiftTest() {
  PushTest test;
  test.name =
      "0.5 kg against gravity along -z for 2 s, friction 0.5, < 2 cm and "
      "< 15 degrees";
  test.mass = 0.5;
  test.force = test.mass * 9.81;
  test.push_seconds = 2.0;
  test.pushes = {-Eigen::Vector3d::UnitZ()};
  return test;
}

const char* SimulatorVersion() {
  static const std::string version =
      fmt::format("MuJoCo {}", mj_versionString());
  return version.c_str();
}

}  // namespace graspdb
