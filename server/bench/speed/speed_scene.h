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

/** Postures of the hand about the object, drawn at random. Deterministic.
 @param postures  How many free ones, and how many that collide.
 @param grasps  How many stable grasps. */
SpeedScene MakeSpeedScene(std::shared_ptr<const HandModel> hand,
                          const TriangleMesh& mesh_O, int postures = 64,
                          int grasps = 64);

}  // namespace graspdb
