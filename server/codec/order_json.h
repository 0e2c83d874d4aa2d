#pragma once

#include <string>

#include "engine/base/result.h"
#include "server/orders.h"

/** @file
 Orders as JSON: the bodies of requests that become jobs, and what the jobs
 table keeps of them. Every reader answers kInvalidArgument with the field at
 fault and what it takes; unknown fields are refused. */

namespace graspdb {

/** POST /v1/objects/{id}/segmentation: {"category", "settings": {...},
 "face_labels": [...] or "faces": {...} as in labels.json, "seed"}, all
 optional. object_id and cascade are the caller's. */
Result<SegmentOrder> SegmentOrderFromJson(const std::string& text);

/** POST /v1/objects/{id}/grasp-spaces: {"parts": [...], "hands": [...],
 "parameters": {...}, "seed"}, all optional; object_id is the caller's. */
Result<LearnOrder> LearnOrderFromJson(const std::string& text);

/** POST /v1/verifications: {"category", "parts": [...], "hand", "object",
 "grasp_space", "transfer", "stage", "limit", "again"}, all optional; no more
 than 1000 grasps unless limit says. */
Result<VerifyOrder> VerifyOrderFromJson(const std::string& text);

// Orders in the jobs table. What may be large is in the job's payload: of a
// mesh first labels_bytes of face labels, as labels.json, if any, then its
// file.
std::string ToJson(const SegmentOrder& order);
std::string ToJson(const VerifyOrder& order);  ///< As POST /v1/verifications.
/** Without bytes and face labels, which are in MakePayload(). */
std::string ToJson(const ImportOrder& order);
std::string MakePayload(const ImportOrder& order);
std::string ToJson(const LearnOrder& order);
std::string ToJson(const TransferOrder& order);
Result<ImportOrder> StoredImportOrderFromJson(const std::string& text,
                                              std::string payload);
Result<SegmentOrder> StoredSegmentOrderFromJson(const std::string& text);
Result<LearnOrder> StoredLearnOrderFromJson(const std::string& text);
Result<TransferOrder> StoredTransferOrderFromJson(const std::string& text,
                                                  std::string payload);

}  // namespace graspdb
