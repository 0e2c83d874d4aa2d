#include "engine/quality/wrench_space.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "engine/base/contract.h"

namespace graspdb {

std::vector<Eigen::Vector3d> CalcFrictionConeEdges(const Eigen::Vector3d& nhat,
                                                   double friction, int edges) {
  GRASPDB_EXPECTS(edges >= 3 && friction >= 0.0);
  const Eigen::Vector3d t1 = nhat.unitOrthogonal();
  const Eigen::Vector3d t2 = nhat.cross(t1);
  std::vector<Eigen::Vector3d> result;
  result.reserve(edges);
  for (int k = 0; k < edges; ++k) {
    const double phi = 2.0 * std::numbers::pi * k / edges;
    result.push_back(nhat +
                     friction * (std::cos(phi) * t1 + std::sin(phi) * t2));
  }
  return result;
}

Wrenches CalcContactWrenches(const std::vector<Contact>& contacts,
                             const MassProperties& mass,
                             const ContactParameters& parameters) {
  GRASPDB_EXPECTS(mass.max_radius > 0.0);
  Wrenches wrenches(6,
                    static_cast<int>(contacts.size()) * parameters.cone_edges);
  int column = 0;
  for (const Contact& contact : contacts) {
    const Eigen::Vector3d arm = (contact.p_O - mass.p_McCM) / mass.max_radius;
    const double share = contact.seen ? 1.0 : parameters.unseen_force;
    for (const Eigen::Vector3d& f : CalcFrictionConeEdges(
             -contact.nhat_O, parameters.friction, parameters.cone_edges)) {
      wrenches.col(column++) << share * f, arm.cross(share * f);
    }
  }
  return wrenches;
}

}  // namespace graspdb
