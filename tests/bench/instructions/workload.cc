// A fixed piece of what transfers and learning spend their time on, for
// instruction_gate.py, which counts the instructions inside Work…().
#include <cstdio>

#include "engine/cspace/configuration_space.h"
#include "engine/dynamics/closing_simulation.h"
#include "engine/planning/grasp_evaluator.h"
#include "server/bench/speed/speed_scene.h"
#include "tests/support/workshop.h"

namespace graspdb::bench {

constexpr int kPostures = 8;
constexpr int kGrasps = 3;

// What is counted: not inlined, so that it can be found by name.
[[gnu::noinline]] double WorkOnGrasps(const SpeedScene& scene) {
  double sum = 0.0;
  const ClosingSimulation simulation(
      scene.hand, scene.solid, scene.parameters.hold, scene.parameters.motors);
  for (const Grasp& grasp : scene.grasps) {
    const RigidTransform& X_OH = grasp.configuration.X_OH;
    for (const Precision precision :
         {Precision::kEstimated, Precision::kExact}) {
      sum += CloseAndJudge(scene.hand, X_OH, grasp.q_pregrasp, scene.solid,
                           scene.parameters, precision)
                 .grasp.quality.epsilon;
    }
    sum += CalcGrip(scene.hand, grasp, scene.solid.mass(), scene.parameters);
    sum += CalcHybrid(scene.hand, grasp, scene.solid, scene.parameters);
    sum += simulation
               .Run(X_OH, grasp.q_pregrasp, scene.parameters.contact.friction,
                    Push::kPlusX)
               .shift;
  }
  return sum;
}

[[gnu::noinline]] int WorkOnPostures(const SpeedScene& scene) {
  int colliding = 0;
  for (const auto* postures : {&scene.free, &scene.colliding}) {
    for (const HandConfiguration& one : *postures) {
      const auto X_HL = CalcLinkPoses(scene.hand.model(), one.q);
      colliding +=
          FindCollidingLink(scene.hand, one.X_OH, X_HL, scene.solid) >= 0;
    }
  }
  return colliding;
}

}  // namespace graspdb::bench

int main() {
  using namespace graspdb;
  const SpeedScene scene = MakeSpeedScene(workshop::LoadBarrettHand(),
                                          workshop::LoadMug("latte").mesh_O,
                                          bench::kPostures, bench::kGrasps);
  std::printf("%g %d\n", bench::WorkOnGrasps(scene),
              bench::WorkOnPostures(scene));
  return 0;
}
