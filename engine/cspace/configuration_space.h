#pragma once

#include <Eigen/Core>

#include "engine/base/random.h"
#include "engine/geometry/solid.h"
#include "engine/hand/hand_model.h"
#include "engine/hand/hand_shape.h"

namespace graspdb {

/** A point of the configuration space: the hand's pose in the object's frame
 and its motors. For the Barrett hand 6 + 4 dimensions. */
struct HandPosture {
  RigidTransform X_OH;
  Eigen::VectorXd actuators;  ///< rad or m, each within its range.
};

/** The region of configurations from which a hand can reach an object, and the
 metric on it. The hand's grasp centre, where its fingers meet, lies within
 `reach` of the object's box; any rotation; any motor position. */
class ConfigurationSpace {
 public:
  ConfigurationSpace(const HandShape& hand, const Solid& solid);

  /** Uniform over the region. */
  HandPosture Sample(Random& random) const;

  /** Uniform over the region, but with the approach aimed at a uniform point of
   the touchable surface. */
  HandPosture SampleAimed(Random& random) const;

  /** The posture changed by at most `step` metres, `turn` radians and the share
   `turn`/π of each motor's range; motors stay within their range. */
  HandPosture Perturb(const HandPosture& posture, double step, double turn,
                      Random& random) const;

  /** Coordinates in which distance is meaningful and rotation has no seam:
   grasp centre over the object's half diagonal, the first two columns of R,
   motors over half their range. */
  Eigen::VectorXd CalcFeatures(const HandPosture& posture) const;

  /** Where the fingers meet, in the hand frame H, m. */
  const Eigen::Vector3d& p_HG() const { return p_HG_; }

  /** True when the posture collides with the object or itself: the label of the
   paper's discrete collision test. @paper{Sec. IV, collision label} */
  bool Collides(const HandPosture& posture) const;

 private:
  const HandShape& hand_;
  const Solid& solid_;
  Eigen::Vector3d p_HG_;
  Eigen::Vector3d region_min_;
  Eigen::Vector3d region_max_;
};

}  // namespace graspdb
