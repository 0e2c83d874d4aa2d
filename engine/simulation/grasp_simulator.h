#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/geometry/triangle_mesh.h"
#include "engine/hand/hand_model.h"
#include "engine/planning/grasp.h"

namespace graspdb {

/** What is simulated and what counts as held. As it stands, the six-push test;
 the others that are published are below. */
struct PushTest {
  std::string name{
      "six pushes of 1 N on 0.1 kg, each from rest, friction 0.5, < 2 cm and "
      "< 15 degrees"};
  /** Directions in frame O, and whether each push is an episode from the
   settled state, or all are one episode that is judged by where it ends. */
  std::vector<Eigen::Vector3d> pushes{
      Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitX(),
      Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitY(),
      Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitZ()};
  bool one_episode{false};
  double friction{0.5};        ///< Coulomb, sliding.
  double torsion{0.003};       ///< Torsional friction, m.
  double mass{0.1};            ///< Of the object, kg, uniform.
  double force{1.0};           ///< Of each push, N.
  double ramp_seconds{0.1};    ///< From zero to that force …
  double push_seconds{1.0};    ///< … which then stays so long.
  double settle_seconds{0.6};  ///< After the fingers have closed.
  double closing_speed{1.0};   ///< Of a motor, rad/s; of a slide 0.1 m/rad.
  double closing_force{5.0};   ///< Of a finger at its tip, N …
  double holding_force{15.0};  ///< … and what its worm gear then stands.
  double stiffness{100.0};     ///< Of a joint until it yields, N m/rad.
  /** Whether the object stays where it is until the fingers have closed, or
   floats from the start: whatever touches it first then pushes it away. */
  bool fixed_while_closing{false};
  double time_step{0.001};              ///< s.
  double max_shift{0.02};               ///< Of the mass centre, m.
  double max_turn{0.2617993877991494};  ///< 15 degrees.
};

/** Friction 3, 1 N along +x +y +z -x -y -z one after another in one episode,
 held when the net displacement stays below 2 cm, however it turns: the kind of
 test that most published success rates are of. */
PushTest MakeNetDisplacementTest();

/** 0.5 kg, friction 0.5, gravity along -z of frame O for 2 s, < 2 cm and < 15
 degrees. */
PushTest MakeLiftTest();

/** What became of one grasp. */
struct PhysicalVerdict {
  bool settled{false};        ///< Moved less than the limits until pushed.
  double settle_shift{0.0};   ///< m.
  double settle_turn{0.0};    ///< rad.
  std::vector<double> shift;  ///< Per episode, m …
  std::vector<double> turn;   ///< … and rad, up to where it was lost.
  std::vector<bool> held;

  /** 0..1, the share of episodes that were withstood; 0 when not settled. */
  double CalcScore() const;
  bool operator==(const PhysicalVerdict&) const = default;
};

/** Judges grasps of one object by one hand in MuJoCo, apart from all that the
 engine itself knows of contacts. The object is at rest in its own frame O,
 without gravity, free as soon as PushTest says; the hand's base is fixed. The
 fingers close from the pre-grasp, each joint until it meets its torque limit,
 and then stand as a worm gear does: springy up to that limit, yielding beyond.
 Then the pushes. Deterministic. May be used by one
 thread at a time. */
class GraspSimulator {
 public:
  /** @param mesh_O  Closed. */
  GraspSimulator(std::shared_ptr<const HandModel> hand,
                 const TriangleMesh& mesh_O, const PushTest& test);
  ~GraspSimulator();
  GraspSimulator(GraspSimulator&&) noexcept;
  GraspSimulator& operator=(GraspSimulator&&) noexcept;

  /** @param grasp  Its pre-grasp joints, and X_OH; the joints where closing
   ended matter only for what does not close.
   @throws std::runtime_error when MuJoCo fails. */
  PhysicalVerdict Judge(const Grasp& grasp);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/** Which simulator, and its version, for provenance. */
const char* SimulatorVersion();

}  // namespace graspdb
