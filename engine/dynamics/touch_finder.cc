#include "engine/dynamics/touch_finder.h"

namespace graspdb {

void TouchFinder::Fill(int link, const RigidTransform& X_OL,
                       Watch& watch) const {
  watch.until = watch.travel + kWatched;
  watch.probes.clear();
  hand_->link(link)->tree.VisitNear(
      PosedField(*field_, X_OL), reach(), [&](const Eigen::Vector3d& p_L) {
        watch.probes.push_back({p_L, watch.travel});
      });
}

}  // namespace graspdb
