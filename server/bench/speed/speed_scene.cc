#include "server/bench/speed/speed_scene.h"

#include <utility>

#include "engine/base/random.h"
#include "engine/planning/grasp_evaluator.h"

namespace graspdb {
namespace {

// The palm looks at a point of the object from a hand's length away.
HandConfiguration DrawPosture(const HandShape& hand, const Solid& solid,
                              Random& random) {
  const TriangleMesh& mesh = solid.mesh_O();
  const int f = random.NextIndex(mesh.num_triangles());
  const Eigen::Matrix3d R_OH = random.NextRotation();
  const Eigen::Vector3d target =
      (mesh.corner(f, 0) + mesh.corner(f, 1) + mesh.corner(f, 2)) / 3.0;
  const double away = random.NextUniform(0.08, 0.16);
  const HandModel& model = hand.model();
  Eigen::VectorXd motors(model.num_actuators());
  for (int a = 0; a < model.num_actuators(); ++a) {
    const HandActuator& actuator = model.actuators()[static_cast<size_t>(a)];
    motors[a] = actuator.closes
                    ? actuator.lower
                    : random.NextUniform(actuator.lower, actuator.upper);
  }
  return {{R_OH, target - away * (R_OH * model.approach_H())},
          model.CalcCoupledJoints(motors)};
}

}  // namespace

SpeedScene MakeSpeedScene(std::shared_ptr<const HandModel> hand,
                          const TriangleMesh& mesh_O, int postures,
                          int grasps) {
  SpeedScene scene{
      HandShape(std::move(hand)), Solid(mesh_O), Parameters(), {}, {}, {}};
  const auto wanted = static_cast<size_t>(postures);
  const auto wanted_grasps = static_cast<size_t>(grasps);
  Random random(1);
  while (scene.free.size() < wanted || scene.colliding.size() < wanted ||
         scene.grasps.size() < wanted_grasps) {
    const HandConfiguration posture =
        DrawPosture(scene.hand, scene.solid, random);
    const bool collides =
        FindCollidingLink(scene.hand, posture.X_OH,
                          CalcLinkPoses(scene.hand.model(), posture.q),
                          scene.solid) >= 0;
    auto& group = collides ? scene.colliding : scene.free;
    if (group.size() < wanted) group.push_back(posture);
    if (collides || scene.grasps.size() == wanted_grasps) continue;
    const EvaluatedGrasp closed = CloseAndJudge(
        scene.hand, posture.X_OH, posture.q, scene.solid, scene.parameters);
    if (closed.ok()) scene.grasps.push_back(closed.grasp);
  }
  return scene;
}

}  // namespace graspdb
