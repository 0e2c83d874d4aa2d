#pragma once

#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/hand/hand_model.h"
#include "server/records.h"

/** @file
 Every record as the JSON that api.md and schema/openapi.yaml describe, as text:
 SI units, poses as position and quaternion, joints by name, numbers that read
 back to the same double, keys always in the same order. A record that is part
 of a list is encoded alone and joined with ListToJson(). */

namespace graspdb {

/** {"items": [...], "next_cursor": ...}; the cursor is null on the last page.
 */
std::string ListToJson(const std::vector<std::string>& items,
                       const std::string& next_cursor);

std::string ToJson(const StoredCategory& category);
/** Without parts: for lists. */
std::string ToJson(const StoredObject& object);
/** With its parts (without their faces): for one object. */
std::string ToJson(const StoredObject& object,
                   const std::vector<StoredPart>& parts);
std::string ToJson(const SimilarObject& similar);
std::string ToJson(const StoredPart& part);
std::string ToJson(const StoredHand& hand, const HandModel& model);
std::string ToJson(const StoredGraspSpace& space);
/** @pre The hand is the grasp's. */
std::string ToJson(const StoredGrasp& grasp, const HandModel& hand);
std::string ToJson(const StoredJob& job);
std::string ToJson(const StoredBackup& backup);
std::string ToJson(const StoreCounts& counts);
std::string ToJson(const CheckReport& report);

/** The answer to POST /v1/grasps: without times, the same bytes for the same
 input. */
std::string ToJson(const TransferAnswer& answer);
/** GET /v1/transfers/{id}: each source grasp, how it ended and why, alignments,
 parameters, times. */
std::string ToJson(const StoredTransfer& transfer);
/** An item of GET /v1/transfers: without attempts, alignments, parameters. */
std::string ToSummaryJson(const StoredTransfer& transfer);

}  // namespace graspdb
