#include "server/bench/paper_bench.h"

namespace graspdb {

std::vector<BenchVariant> MakeAblations() {
  std::vector<BenchVariant> ablations;
  const auto without = [&ablations](const std::string& name,
                                    const auto& change) {
    ablations.push_back({"default without " + name, MakeDefaultParameters()});
    change(ablations.back().parameters);
  };
  without("the wrist's motion",
          [](Parameters& p) { p.replan.move_wrist = false; });
  without("aimed starts", [](Parameters& p) { p.replan.aimed_starts = false; });
  without("repeated annealing", [](Parameters& p) { p.replan.cycles = 1; });
  without("bending", [](Parameters& p) { p.mapping.warp_steps = 0; });
  without("affine mapping and bending", [](Parameters& p) {
    p.mapping.affine = false;
    p.mapping.warp_steps = 0;
  });
  without("examples that hold on the whole",
          [](Parameters& p) { p.swarm.hold_on_whole = false; });
  without("examples that the motors hold",
          [](Parameters& p) { p.swarm.min_grip = 0.0; });
  without("fingers that meet the object together",
          [](Parameters& p) { p.pregrasp.timed = false; });
  without("climbing to a surer grip",
          [](Parameters& p) { p.replan.climb_samples = 0; });
  without("further searches", [](Parameters& p) { p.replan.searches = 1; });
  without("aiming beyond open-close",
          [](Parameters& p) { p.replan.behind_cost = 0.0; });
  without("the motors' balance in Eq. (6)",
          [](Parameters& p) { p.replan.grip_weight = 0.0; });
  without("grip when grasps are chosen",
          [](Parameters& p) { p.replan.grip_copies = 0; });
  without("pushes when grasps are chosen",
          [](Parameters& p) { p.hold.push = 0.0; });
  without("niches", [](Parameters& p) { p.swarm.niches = false; });
  without("shunning what fell through",
          [](Parameters& p) { p.swarm.shun_failed = false; });
  without("starts near what was found",
          [](Parameters& p) { p.swarm.near_share = 0.0; });
  return ablations;
}

}  // namespace graspdb
