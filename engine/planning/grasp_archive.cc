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

bool GraspArchive::Insert(const Grasp& grasp) {
  const auto near = [&](const Grasp& other) {
    return CalcGraspDifference(grasp, other, parameters_) < 1.0;
  };
  const bool beaten =
      std::any_of(grasps_.begin(), grasps_.end(), [&](const Grasp& other) {
        return near(other) && other.quality.epsilon >= grasp.quality.epsilon;
      });
  if (beaten) return false;
  grasps_.erase(std::remove_if(grasps_.begin(), grasps_.end(), near),
                grasps_.end());
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
