#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/hand/hand_model.h"
#include "server/records.h"

namespace graspdb {

/** A stored grasp and the hand that does it. */
struct GraspOfHand {
  const StoredGrasp* grasp{nullptr};
  std::shared_ptr<const HandModel> hand;
};

/** One line per grasp after a header line (RFC 4180): ids, quality, X_OH as
 position and quaternion, the approach, then one column per joint of any of the
 hands, empty where a hand does not have it. SI units. */
std::string GraspsToCsv(const std::vector<GraspOfHand>& grasps);

/** A JSON list of ROS moveit_msgs/Grasp messages. Poses are those of the hand
 base H in the object's frame, whose frame_id is "object". */
std::string GraspsToRos(const std::vector<GraspOfHand>& grasps);

}  // namespace graspdb
