#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/codec/json.h"
#include "server/records.h"

/** @file
 What the paper's tables say of one part of one object, as JSON. What counts is
 defined in engine/docs/notation.md; nothing is filtered before it is counted.
 */

namespace graspdb {

/** The verdicts of further simulated tests on assembled grasps: by the test's
 key, by the grasp's id. */
using TestScores = std::map<std::string, std::map<std::string, double>>;

/** Table I and more: one learned grasp space.
 @param triangles  Of the part's surface.
 @param grasps  What was learned of it. @param part_O  The part's solid. */
Json MakeLearningRow(const StoredGraspSpace& space, int triangles,
                     const std::vector<Grasp>& grasps,
                     const TriangleMesh& part_O);

/** Tables II and III and more: one part of a transfer's object.
 @param grasps  Those of both stages, in the order in which a server ranks them.
 @param further  Of tests besides the one that is stored. */
Json MakeTransferRow(const StoredTransfer& transfer, const StoredPart& part,
                     const std::vector<StoredGrasp>& grasps,
                     const TestScores& further);

/** An object that could not be transferred to: all its grasps failed. */
Json MakeFailedRow(const std::string& part, int attempts, const Error& error);

/** Sums of transfer rows: {"rows", "attempted", "transferred": {"hits",
 "count", "share", "lower", "upper"}, …}. */
Json PoolRows(const std::vector<Json>& rows);

/** {"hits", "count", "share", "lower", "upper"} with Wilson's interval. */
Json EncodeProportion(int hits, int count);

}  // namespace graspdb
