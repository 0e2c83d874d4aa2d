#include "engine/cspace/configuration_space.h"

#include <algorithm>
#include <cmath>

namespace graspdb {
namespace {

// The grasp centre may lie this far outside the object's box, metres.
constexpr double kReach = 0.03;

// The mean of the closing links' contact points with the fingers half closed.
Eigen::Vector3d FindGraspCenter(const HandModel& hand) {
  Eigen::VectorXd motors(hand.num_actuators());
  for (int a = 0; a < hand.num_actuators(); ++a) {
    const HandActuator& actuator = hand.actuators()[a];
    motors[a] = actuator.closes ? 0.5 * (actuator.lower + actuator.upper)
                                : actuator.lower;
  }
  const auto X_HL = CalcLinkPoses(hand, hand.CalcCoupledJoints(motors));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const HandContactPoint& point : hand.contact_points()) {
    if (point.link == 0) continue;
    sum += X_HL[point.link] * point.p_L;
    ++count;
  }
  if (count == 0) return Eigen::Vector3d::Zero();
  // On the approach axis, so that the hand closes about what it aims at.
  return hand.approach_H() * hand.approach_H().dot(sum / count);
}

}  // namespace

ConfigurationSpace::ConfigurationSpace(const HandShape& hand,
                                       const Solid& solid)
    : hand_(hand),
      solid_(solid),
      p_HG_(FindGraspCenter(hand.model())),
      region_min_(solid.mesh_O().box_min() - Eigen::Vector3d::Constant(kReach)),
      region_max_(solid.mesh_O().box_max() +
                  Eigen::Vector3d::Constant(kReach)) {}

HandPosture ConfigurationSpace::Sample(Random& random) const {
  HandPosture posture;
  posture.X_OH.rotation = random.NextRotation();
  Eigen::Vector3d p_OG;
  for (int k = 0; k < 3; ++k) {
    p_OG[k] = random.NextUniform(region_min_[k], region_max_[k]);
  }
  posture.X_OH.translation = p_OG - posture.X_OH.rotation * p_HG_;
  const HandModel& hand = hand_.model();
  posture.actuators.resize(hand.num_actuators());
  for (int a = 0; a < hand.num_actuators(); ++a) {
    posture.actuators[a] = random.NextUniform(hand.actuators()[a].lower,
                                              hand.actuators()[a].upper);
  }
  return posture;
}

HandPosture ConfigurationSpace::SampleAimed(Random& random) const {
  HandPosture posture = Sample(random);
  const TriangleMesh& mesh = solid_.mesh_O();
  // A uniform point of the surface: a face by area, a point of it.
  int face = 0;
  do {
    double area = random.NextUniform() * mesh.total_area();
    face = 0;
    while (face + 1 < mesh.num_triangles() && area > mesh.area(face)) {
      area -= mesh.area(face++);
    }
  } while (solid_.is_cap(face));
  const double u = std::sqrt(random.NextUniform());
  const double v = random.NextUniform();
  const Eigen::Vector3d p_O = (1 - u) * mesh.corner(face, 0) +
                              u * (1 - v) * mesh.corner(face, 1) +
                              u * v * mesh.corner(face, 2);
  const double depth = p_HG_.norm() + random.NextUniform(-kReach, kReach);
  posture.X_OH.translation =
      p_O - depth * (posture.X_OH.rotation * hand_.model().approach_H());
  // Open hands: the fingers are to close about the object.
  for (int a = 0; a < hand_.model().num_actuators(); ++a) {
    const HandActuator& actuator = hand_.model().actuators()[a];
    if (!actuator.closes) continue;
    posture.actuators[a] =
        actuator.lower +
        0.4 * random.NextUniform() * (actuator.upper - actuator.lower);
  }
  return posture;
}

HandPosture ConfigurationSpace::Perturb(const HandPosture& posture, double step,
                                        double turn, Random& random) const {
  HandPosture result = posture;
  // About the grasp centre, so that turning does not swing the hand away.
  const Eigen::Vector3d p_OG = posture.X_OH * p_HG_;
  result.X_OH.rotation =
      posture.X_OH.rotation * random.NextRotationWithin(turn);
  result.X_OH.translation =
      p_OG + step * random.NextInUnitBall() - result.X_OH.rotation * p_HG_;
  for (int a = 0; a < hand_.model().num_actuators(); ++a) {
    const HandActuator& actuator = hand_.model().actuators()[a];
    const double range = actuator.upper - actuator.lower;
    result.actuators[a] =
        std::clamp(posture.actuators[a] +
                       random.NextUniform(-1.0, 1.0) * range * turn / M_PI,
                   actuator.lower, actuator.upper);
  }
  return result;
}

Eigen::VectorXd ConfigurationSpace::CalcFeatures(
    const HandPosture& posture) const {
  const HandModel& hand = hand_.model();
  Eigen::VectorXd features(9 + hand.num_actuators());
  const Eigen::Vector3d middle =
      0.5 * (solid_.mesh_O().box_min() + solid_.mesh_O().box_max());
  features.head<3>() =
      (posture.X_OH * p_HG_ - middle) / (0.5 * solid_.mesh_O().diagonal());
  features.segment<3>(3) = posture.X_OH.rotation.col(0);
  features.segment<3>(6) = posture.X_OH.rotation.col(1);
  for (int a = 0; a < hand.num_actuators(); ++a) {
    const HandActuator& actuator = hand.actuators()[a];
    features[9 + a] = 2.0 * (posture.actuators[a] - actuator.lower) /
                          std::max(1e-9, actuator.upper - actuator.lower) -
                      1.0;
  }
  return features;
}

bool ConfigurationSpace::Collides(const HandPosture& posture) const {
  const auto X_HL = CalcLinkPoses(
      hand_.model(), hand_.model().CalcCoupledJoints(posture.actuators));
  return FindCollidingLink(hand_, posture.X_OH, X_HL, solid_) >= 0 ||
         FindSelfCollision(hand_, X_HL).has_value();
}

}  // namespace graspdb
