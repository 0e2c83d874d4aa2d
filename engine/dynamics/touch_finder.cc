#include "engine/dynamics/touch_finder.h"

#include <algorithm>

namespace graspdb {

void TouchFinder::Fill(int link, const RigidTransform& X_OL,
                       Watch& watch) const {
  watch.probes.clear();
  const double others = hand_->link(link)->tree.VisitNear(
      PosedField(*field_, X_OL), kWatched + near_,
      [&](const Eigen::Vector3d& p_L, double distance) {
        watch.probes.push_back({p_L, watch.travel + distance - near_});
      });
  watch.until = watch.travel + std::min(others - near_, kLongestWatch);
}

}  // namespace graspdb
