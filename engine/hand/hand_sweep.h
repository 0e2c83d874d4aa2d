#pragma once

#include "engine/geometry/solid.h"
#include "engine/hand/hand_model.h"
#include "engine/hand/hand_shape.h"

namespace graspdb {

/** The configuration a share t in [0, 1] of the way: position and joints
 linearly, rotation about one axis. */
HandConfiguration Interpolate(const HandConfiguration& from,
                              const HandConfiguration& to, double t);

/** The first contact of the moving hand with the solid or with itself, as a
 share of the way; 1 when the whole way is free. The configuration at the result
 is free of collision and within 0.02 mm of motion of a colliding one. Steps are
 bounded by the gap, so that nothing thicker than `fine_step` is passed through;
 only grazes that last less than fine_step of motion can be missed.
 @param fine_step  Where the gap cannot be proven, the exact test steps by so
   much motion of the fastest link, m.
 @pre The hand at `from` collides with nothing; fine_step > 0. */
double FindFirstContact(const HandShape& hand, const HandConfiguration& from,
                        const HandConfiguration& to, const Solid& solid,
                        double fine_step);

}  // namespace graspdb
