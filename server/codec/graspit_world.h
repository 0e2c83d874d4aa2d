#pragma once

#include <string>
#include <vector>

#include "engine/hand/hand_model.h"
#include "server/codec/input_json.h"
#include "server/records.h"

namespace graspdb {

/** Grasps as one world of GraspIt!, version 4: a body
 models/objects/<object id>.xml for each object at the world's origin, and a
 robot for each grasp. Millimetres, as GraspIt! has them; a finger that broke
 away says so with the angle where its inner joint stopped. All are of the hand
 `hand`, `model` being what hand.json says of it. */
std::string GraspsToGraspit(const std::vector<const StoredGrasp*>& grasps,
                            const HandModel& hand, const GraspitModel& model);

}  // namespace graspdb
