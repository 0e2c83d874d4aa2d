#pragma once

#include <string>

#include "server/codec/json.h"

namespace graspdb {

/** What RunPaperBench() found, as one HTML page that needs no other file: the
 paper's tables with its numbers beside ours, and its figures.
 @param report  See paper_bench.h. */
std::string MakeHtmlReport(const Json& report);

/** The main figures as a table for a terminal. */
std::string MakeTextReport(const Json& report);

}  // namespace graspdb
