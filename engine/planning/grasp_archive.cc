#include "engine/planning/grasp_archive.h"

#include <algorithm>

namespace graspdb {

double CalcGraspDifference(const Grasp& a, const Grasp& b,
                           const DistinctParameters& parameters) {
  const HandConfiguration& x = a.configuration;
  const HandConfiguration& y = b.configuration;
  return (x.X_OH.translation - y.X_OH.translation).norm() /
             parameters.position +
         CalcRotationAngle(x.X_OH.rotation.transpose() * y.X_OH.rotation) /
             parameters.angle +
         (x.q - y.q).cwiseAbs().maxCoeff() / parameters.joint;
}

bool GraspArchive::Wants(const Grasp& grasp) const {
  return std::none_of(grasps_.begin(), grasps_.end(), [&](const Grasp& other) {
    return IsNear(grasp, other) &&
           other.quality.epsilon >= grasp.quality.epsilon;
  });
}

bool GraspArchive::Insert(const Grasp& grasp) {
  if (!Wants(grasp)) return false;
  std::erase_if(grasps_,
                [&](const Grasp& other) { return IsNear(grasp, other); });
  grasps_.push_back(grasp);
  return true;
}

std::vector<Grasp> GraspArchive::MakeSorted() const {
  std::vector<Grasp> sorted = grasps_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Grasp& a, const Grasp& b) {
                     return a.quality.epsilon > b.quality.epsilon;
                   });
  return sorted;
}

}  // namespace graspdb
