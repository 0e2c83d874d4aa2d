#pragma once

namespace graspdb {

/** How one source grasp ended at one stage. */
enum class TransferOutcome {
  kSucceeded,
  kNoCorrespondence,  ///< Fewer than two opposed contacts could be mapped.
  kPalmCollision,     ///< The palm collides and no retreat helped.
  kFingerCollision,   ///< No collision-free finger posture was found.
  kNoContact,         ///< The fingers met nothing, or only a cap.
  kUnstable,          ///< Closed, but eps stays below the limit.
  kTooFar,            ///< Stable, but too far from the example's grasp.
  kUnreachable,       ///< No collision-free way leads to it.
  kNotKeptFree,       ///< Too near a part that the task keeps free.
};

/** The name on the wire, e.g. "palm_collision". */
const char* ToString(TransferOutcome outcome);

}  // namespace graspdb
