#pragma once

#include <vector>

#include "engine/parameters/parameters.h"
#include "engine/planning/grasp.h"

namespace graspdb {

/** How different two grasps are: |Δp| / position + angle / angle + max |Δq| /
 joint, each over its parameter; at least 1 when they count as two. */
double CalcGraspDifference(const Grasp& a, const Grasp& b,
                           const DistinctParameters& parameters);

/** The distinct grasps found so far. Of near-duplicates the one with the larger
 ε stays. */
class GraspArchive {
 public:
  explicit GraspArchive(const DistinctParameters& parameters)
      : parameters_(parameters) {}

  /** Whether Insert() would keep it. */
  bool Wants(const Grasp& grasp) const;
  /** True when the grasp was kept. */
  bool Insert(const Grasp& grasp);

  int size() const { return static_cast<int>(grasps_.size()); }
  /** In the order in which they were found. */
  const std::vector<Grasp>& grasps() const { return grasps_; }
  /** In order of ε, the largest first. */
  std::vector<Grasp> MakeSorted() const;

 private:
  bool IsNear(const Grasp& a, const Grasp& b) const {
    return CalcGraspDifference(a, b, parameters_) < 1.0;
  }

  DistinctParameters parameters_;
  std::vector<Grasp> grasps_;
};

}  // namespace graspdb
