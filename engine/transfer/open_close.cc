#include "engine/transfer/open_close.h"

#include "engine/planning/grasp_evaluator.h"

namespace graspdb {

double CalcOpenCloseEpsilon(const HandShape& hand, const TransferTask& task,
                            const Solid& solid, const Parameters& parameters) {
  const HandModel& model = hand.model();
  Eigen::VectorXd motors = model.CalcActuators(task.q_pregrasp);
  // Straighten each finger that collides.
  const auto X_HL = CalcLinkPoses(model, model.CalcCoupledJoints(motors));
  for (int a = 0; a < model.num_actuators(); ++a) {
    if (!model.actuators()[a].closes) continue;
    for (size_t k = 0; k < model.actuators()[a].joints.size(); ++k) {
      for (const int link : hand.chain_links(a, static_cast<int>(k))) {
        if (hand.link(link) &&
            LinkCollides(*hand.link(link), task.X_NH * X_HL[link], solid)) {
          motors[a] = model.actuators()[a].lower;
        }
      }
    }
  }
  const EvaluatedGrasp grasp = CloseAndJudge(
      hand, task.X_NH, model.CalcCoupledJoints(motors), solid, parameters);
  return grasp.ok() ? grasp.grasp.quality.epsilon : 0.0;
}

}  // namespace graspdb
