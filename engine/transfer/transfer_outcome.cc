#include "engine/transfer/transfer_outcome.h"

namespace graspdb {

const char* ToString(TransferOutcome outcome) {
  switch (outcome) {
    case TransferOutcome::kSucceeded:
      return "succeeded";
    case TransferOutcome::kNoCorrespondence:
      return "no_correspondence";
    case TransferOutcome::kPalmCollision:
      return "palm_collision";
    case TransferOutcome::kFingerCollision:
      return "finger_collision";
    case TransferOutcome::kNoContact:
      return "no_contact";
    case TransferOutcome::kUnstable:
      return "unstable";
    case TransferOutcome::kTooFar:
      return "too_far";
    case TransferOutcome::kUnreachable:
      return "unreachable";
    case TransferOutcome::kNotKeptFree:
      return "not_kept_free";
  }
  return "unknown";
}

}  // namespace graspdb
