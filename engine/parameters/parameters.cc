#include "engine/parameters/parameters.h"

#include <sstream>

namespace graspdb {

Parameters MakeDefaultParameters() { return {}; }

Parameters MakePaperParameters() {
  Parameters p;
  p.segmentation.by_shape_diameter = true;
  p.active_learning.seed_samples = 30000;
  p.active_learning.rounds = 2;
  p.active_learning.queries_per_round = 5000;
  p.swarm.aimed_share = 0.0;
  p.swarm.niches = false;
  p.swarm.hold_on_whole = false;
  p.swarm.iterations = 120;
  p.swarm.min_grip = 0.0;
  p.swarm.grip_weight = 0.0;
  p.swarm.near_share = 0.0;
  p.swarm.shun_failed = false;
  p.swarm.patience = p.swarm.iterations;
  p.pregrasp.timed = false;
  p.mapping.affine = false;
  p.mapping.warp_steps = 0;
  p.replan.cycles = 1;
  p.replan.aimed_starts = false;
  p.replan.iterations = 300;
  p.replan.patience = 300;
  p.replan.move_wrist = false;
  p.replan.grip_weight = 0.0;
  p.replan.grip_copies = 0;
  return p;
}

Parameters SelectForLearning(const Parameters& parameters) {
  Parameters selected = parameters;
  selected.segmentation = {};
  selected.mapping = {};
  selected.replan = {};
  // Examples are not pushed, see ADR 14.
  selected.hold.push = HoldParameters().push;
  selected.hold.push_seconds = HoldParameters().push_seconds;
  return selected;
}

Result<void> ValidateParameters(const Parameters& parameters) {
  Result<void> result;
  VisitFields(parameters, [&](const std::string& path, auto value,
                              const ParameterInfo& info) {
    const double number = static_cast<double>(value);
    if (!result || (number >= info.minimum && number <= info.maximum)) return;
    std::ostringstream text;
    text << path << " must lie in [" << info.minimum << ", " << info.maximum
         << "] " << info.unit << ", not " << number;
    result = Error{ErrorCode::kInvalidArgument, text.str(),
                   "GET /v1/parameters lists every range", path};
  });
  return result;
}

}  // namespace graspdb
