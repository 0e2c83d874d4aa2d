#pragma once

namespace graspdb {

/** A point cloud as it was understood. */
struct CloudReport {
  int num_points{0};      ///< In the file, with a position.
  int num_outliers{0};    ///< Of them left out.
  double spacing{0.0};    ///< Of neighbouring points, m: one over √density.
  double noise{0.0};      ///< Rms distance from the local plane, m.
  bool one_sided{false};  ///< Seen from one side only.

  bool operator==(const CloudReport&) const = default;
};

/** A point of the cloud this near shows a place of the surface, m. */
inline double CalcSeenReach(const CloudReport& report) {
  return 2.0 * (report.spacing + report.noise);
}

}  // namespace graspdb
