#include "engine/planning/grasp_evaluator.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/geometry/surface_patch.h"
#include "engine/hand/hand_sweep.h"
#include "engine/quality/contact_extraction.h"
#include "engine/quality/epsilon_quality.h"
#include "engine/quality/grip_balance.h"
#include "engine/quality/hybrid_measure.h"
#include "engine/quality/wrench_space.h"

namespace graspdb {
namespace {

// Shares of a motor's range that are tried in turn, see TimeFingers().
constexpr double kTravels[] = {0.5, 0.35, 0.25, 0.125, 0.06, 0.03};
constexpr double kSameJoints = 0.01;           // rad; section "reachable".
constexpr double kApproachStep = 0.0005;       // m
constexpr double kPenetrationSpacing = 0.001;  // m

// Visits patches of at most the spacing that may lie inside the solid.
void VisitInside(const SurfacePatch& patch, const RigidTransform& X_OL,
                 const Solid& solid, const PosedField& field, double& deepest) {
  if (field(patch.p) - solid.field().max_error() > patch.radius) return;
  if (patch.radius > kPenetrationSpacing) {
    for (const SurfacePatch& half : SplitPatch(patch)) {
      VisitInside(half, X_OL, solid, field, deepest);
    }
    return;
  }
  deepest = std::min(deepest, solid.index().CalcSignedDistance(X_OL * patch.p));
}

}  // namespace

double CalcEpsilon(const std::vector<Contact>& contacts,
                   const MassProperties& mass,
                   const ContactParameters& parameters) {
  if (contacts.size() < 2) return -1.0;
  return CalcEpsilonQuality(CalcContactWrenches(contacts, mass, parameters));
}

EvaluatedGrasp CloseAndJudge(const HandShape& hand, const RigidTransform& X_OH,
                             const Eigen::VectorXd& q_pregrasp,
                             const Solid& solid, const Parameters& parameters,
                             Precision precision) {
  EvaluatedGrasp result;
  Grasp& grasp = result.grasp;
  grasp.configuration = {X_OH, q_pregrasp};
  grasp.q_pregrasp = q_pregrasp;
  grasp.approach_O = X_OH.rotation * hand.model().approach_H();
  grasp.retreat = parameters.pregrasp.retreat;
  grasp.quality.epsilon = -1.0;

  const auto X_HL_open = CalcLinkPoses(hand.model(), q_pregrasp);
  const int colliding =
      precision == Precision::kExact
          ? FindCollidingLink(hand, X_OH, X_HL_open, solid)
          : EstimateCollidingLink(hand, X_OH, X_HL_open, solid);
  if (colliding >= 0) {
    result.failure = colliding == 0 ? GraspFailure::kPalmCollision
                                    : GraspFailure::kFingerCollision;
    return result;
  }
  if (FindSelfCollision(hand, X_HL_open)) {
    result.failure = GraspFailure::kFingerCollision;
    return result;
  }
  grasp.configuration.q =
      CloseFingers(hand, X_OH, q_pregrasp, solid, precision);
  const auto X_HL = CalcLinkPoses(hand.model(), grasp.configuration.q);
  grasp.contacts = ExtractContacts(hand, X_OH, X_HL, solid, parameters.contact);
  if (grasp.contacts.size() < 2) {
    result.failure = GraspFailure::kNoContact;
    return result;
  }
  grasp.quality.epsilon =
      CalcEpsilon(grasp.contacts, solid.mass(), parameters.contact);
  if (grasp.quality.epsilon < parameters.contact.stable_epsilon) {
    result.failure = GraspFailure::kUnstable;
  }
  return result;
}

double CalcHybrid(const HandShape& hand, const Grasp& grasp, const Solid& solid,
                  const Parameters& parameters) {
  const auto X_HL = CalcLinkPoses(hand.model(), grasp.configuration.q);
  return CalcHybridGraspMeasure(
      FindPointPairs(hand.model(), grasp.configuration.X_OH, X_HL, solid),
      grasp.quality.epsilon, parameters.hybrid, parameters.contact.tolerance);
}

bool IsReachable(const HandShape& hand, const Grasp& grasp,
                 const Solid& solid) {
  HandConfiguration away{grasp.configuration.X_OH, grasp.q_pregrasp};
  away.X_OH.translation -= grasp.retreat * grasp.approach_O;
  const auto X_HL = CalcLinkPoses(hand.model(), away.q);
  if (FindCollidingLink(hand, away.X_OH, X_HL, solid) >= 0) return false;
  return FindFirstContact(hand, away,
                          {grasp.configuration.X_OH, grasp.q_pregrasp}, solid,
                          kApproachStep) == 1.0;
}

Grasp TimeFingers(const HandShape& hand, const Grasp& grasp, const Solid& solid,
                  const Parameters& parameters, Precision precision) {
  if (!parameters.pregrasp.timed) return grasp;
  const HandModel& model = hand.model();
  // Where each motor's first joint is blocked, and how far all can be from it.
  Eigen::VectorXd blocked = model.CalcActuators(grasp.q_pregrasp);
  double most = 1.0;
  for (int a = 0; a < model.num_actuators(); ++a) {
    const HandActuator& actuator = model.actuators()[static_cast<size_t>(a)];
    if (!actuator.closes) continue;
    const int first = actuator.joints.front();
    blocked[a] = grasp.configuration.q[first] /
                 model.joints()[static_cast<size_t>(first)].ratio;
    most = std::min(most, (blocked[a] - actuator.lower) /
                              (actuator.upper - actuator.lower));
  }
  std::vector<double> travels{most};
  for (const double travel : kTravels) {
    if (travel < most) travels.push_back(travel);
  }
  for (const double travel : travels) {
    Eigen::VectorXd motors = blocked;
    for (int a = 0; a < model.num_actuators(); ++a) {
      const HandActuator& actuator = model.actuators()[static_cast<size_t>(a)];
      if (actuator.closes) {
        motors[a] -= travel * (actuator.upper - actuator.lower);
      }
    }
    const EvaluatedGrasp timed = CloseAndJudge(hand, grasp.configuration.X_OH,
                                               model.CalcCoupledJoints(motors),
                                               solid, parameters, precision);
    if (timed.ok() &&
        (timed.grasp.configuration.q - grasp.configuration.q)
                .cwiseAbs()
                .maxCoeff() <= kSameJoints &&
        IsReachable(hand, timed.grasp, solid)) {
      return timed.grasp;
    }
  }
  return grasp;
}

double CalcGrip(const HandShape& hand, const Grasp& grasp,
                const MassProperties& mass, const Parameters& parameters,
                double enough) {
  return CalcGripResidual(hand, grasp.configuration.X_OH,
                          CalcLinkPoses(hand.model(), grasp.configuration.q),
                          grasp.contacts, mass, parameters.contact,
                          parameters.grip, parameters.motors, enough);
}

double CalcPenetration(const HandShape& hand,
                       const HandConfiguration& configuration,
                       const Solid& solid) {
  const auto X_HL = CalcLinkPoses(hand.model(), configuration.q);
  double deepest = 0.0;
  for (int i = 0; i < hand.model().num_links(); ++i) {
    if (!hand.link(i)) continue;
    const RigidTransform X_OL = configuration.X_OH * X_HL[i];
    const PosedField field(solid.field(), X_OL);
    const TriangleMesh& mesh_L = hand.link(i)->mesh_L;
    for (int f = 0; f < mesh_L.num_triangles(); ++f) {
      VisitInside(MakeSurfacePatch({mesh_L.corner(f, 0), mesh_L.corner(f, 1),
                                    mesh_L.corner(f, 2)}),
                  X_OL, solid, field, deepest);
    }
    // The object's vertices within the link.
    const RigidTransform X_LO = X_OL.Inverse();
    const Eigen::Vector3d& center = hand.link(i)->tree.center();
    const double radius = hand.link(i)->tree.radius();
    for (const Eigen::Vector3d& p_O : solid.mesh_O().vertices()) {
      const Eigen::Vector3d p_L = X_LO * p_O;
      if ((p_L - center).squaredNorm() > radius * radius) continue;
      for (const TriangleMesh& piece : hand.model().links()[i].pieces_L) {
        // Inside a convex piece by how much: the nearest of its face planes.
        double inside = -1.0;
        for (int f = 0; f < piece.num_triangles(); ++f) {
          inside =
              std::max(inside, piece.normal(f).dot(p_L - piece.corner(f, 0)));
        }
        deepest = std::min(deepest, inside);
      }
    }
  }
  return std::max(0.0, -deepest);  // Not -0.
}

}  // namespace graspdb
