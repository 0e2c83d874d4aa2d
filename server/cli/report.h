#pragma once

#include <string>
#include <vector>

#include "server/jobs/service.h"

/** @file
 Answers for people: JSON of schema/openapi.yaml as lines of text. */

namespace graspdb {

/** POST /v1/grasps: a table of grasps, then the summary. */
std::string ReportTransfer(const std::string& answer);
/** A list of grasps. */
std::string ReportGrasps(const std::string& list);
/** An object with its parts. */
std::string ReportObject(const std::string& object);
/** A list of grasp spaces. */
std::string ReportGraspSpaces(const std::string& list);
/** {"simulator", "friction", …, "grasps": [{"id", "physical", …}]} */
std::string VerificationToJson(const std::vector<VerifiedGrasp>& verified);
/** The same for people: counts per category and part. */
std::string ReportVerification(const std::string& verification);
/** What a check of the database found. */
std::string ReportCheck(const std::string& check);

}  // namespace graspdb
