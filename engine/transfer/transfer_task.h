#pragma once

#include <vector>

#include "engine/hand/hand_model.h"
#include "engine/parameters/parameters.h"
#include "engine/planning/grasp.h"

namespace graspdb {

/** A contact of the source grasp and its image on the novel object. */
struct ContactTarget {
  int link{0};
  Eigen::Vector3d p_L;     ///< Where the source grasp's link touched, frame L.
  Eigen::Vector3d nhat_L;  ///< Out of the link there.
  Eigen::Vector3d p_N;     ///< d_i on the novel object, m.
  Eigen::Vector3d nhat_N;  ///< Out of the novel object there.
};

/** One source grasp, carried over to the novel object. */
struct TransferTask {
  RigidTransform X_NH;         ///< T* X_EH: what the grasp must stay near.
  Eigen::VectorXd q_pregrasp;  ///< The source grasp's open joints.
  Eigen::VectorXd q;           ///< The source grasp's closed joints.
  std::vector<ContactTarget> targets;  ///< Contacts that could be mapped.
};

/** What section 8 asks of a transferred grasp beyond stability: the hand near
 T* X_EH, and opposed contacts near their targets. */
bool IsTransferOf(const TransferTask& task, const Grasp& grasp,
                  const TransferLimits& limits);

/** Where the hand with the source grasp's closed joints brings its contacts
 nearest to their targets, in the least-squares sense, while its frame stays
 near T* X_EH. */
RigidTransform FitWrist(const HandModel& hand, const TransferTask& task);

/** The pose nearest to X_NH that may still be called a transfer of the source
 grasp: within the limits around T* X_EH. */
RigidTransform Confine(const RigidTransform& X_NH, const TransferTask& task,
                       const TransferLimits& limits);

}  // namespace graspdb
