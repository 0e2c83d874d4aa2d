#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/bench/speed/stopwatch.h"
#include "server/codec/json.h"

namespace graspdb {

/** The same work by a library's plain call. */
struct LibraryTiming {
  std::string call;
  Timing timing;
};

/** One measurement of the report:
 {"name", "triangles", "seconds", "library", "goal"}, the optional ones null
 when they are not given; "library" is {"call", "seconds", "times"}, the last
 how many times as long it takes. */
struct SpeedRow {
  std::string name;
  std::optional<int> triangles;
  Timing timing;
  std::optional<LibraryTiming> library;
  std::optional<double> goal;  ///< Of the median, s.
};

Json EncodeSpeedRow(const SpeedRow& row);
Json EncodeSpeedRows(const std::vector<SpeedRow>& rows);

/** Points of a growth curve: {"name", "x_label", "y_label", "x", "y"}. */
struct GrowthCurve {
  std::string name;
  std::string x_label;
  std::string y_label;
  std::vector<double> x;
  std::vector<double> y;
};

Json EncodeGrowthCurve(const GrowthCurve& curve);

}  // namespace graspdb
