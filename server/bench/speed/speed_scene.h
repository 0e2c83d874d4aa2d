#pragma once

#include <memory>
#include <vector>

#include "engine/geometry/solid.h"
#include "engine/hand/hand_shape.h"
#include "engine/parameters/parameters.h"
#include "engine/planning/grasp.h"

namespace graspdb {

/** A hand about an object: what hot functions are measured on. */
struct SpeedScene {
  HandShape hand;
  Solid solid;
  Parameters parameters;
  std::vector<HandConfiguration> free;       ///< Open, near, no collision.
  std::vector<HandConfiguration> colliding;  ///< Some link does.
  std::vector<Grasp> grasps;                 ///< Stable ones.
};

/** Postures of the hand about the object, drawn at random: 64 of each kind.
 Deterministic.
 @param grasps  Whether stable grasps are looked for, too. */
SpeedScene MakeSpeedScene(std::shared_ptr<const HandModel> hand,
                          const TriangleMesh& mesh_O, bool grasps = true);

}  // namespace graspdb
