#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/geometry/triangle_mesh.h"
#include "engine/parameters/grasp_parameters.h"
#include "engine/quality/contact.h"

namespace graspdb {

/** Forces (N) over torques divided by the object's largest radius (N). */
using Wrench = Eigen::Matrix<double, 6, 1>;
using Wrenches = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/** The edges of the friction cone at a contact with inward normal nhat, each
 with unit normal component: nhat + μ (cos φ t1 + sin φ t2) at equal φ. */
std::vector<Eigen::Vector3d> CalcFrictionConeEdges(const Eigen::Vector3d& nhat,
                                                   double friction, int edges);

/** The wrenches that unit normal forces along all cone edges of all contacts
 exert on the object, about its mass centre; hard point contacts with friction.
 One column per edge. */
Wrenches CalcContactWrenches(const std::vector<Contact>& contacts,
                             const MassProperties& mass,
                             const ContactParameters& parameters);

}  // namespace graspdb
