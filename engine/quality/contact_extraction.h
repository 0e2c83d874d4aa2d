#pragma once

#include <vector>

#include "engine/geometry/solid.h"
#include "engine/hand/hand_shape.h"
#include "engine/parameters/grasp_parameters.h"
#include "engine/quality/contact.h"

namespace graspdb {

/** The contacts of a hand at X_OH with link poses X_HL: where a link's and the
 object's surface are at most parameters.tolerance apart with opposed normals;
 per link and patch of similar normals the extreme points, at most four, that
 are min_separation apart. Points on caps of a part do not count. Ordered by
 link. */
std::vector<Contact> ExtractContacts(const HandShape& hand,
                                     const RigidTransform& X_OH,
                                     const std::vector<RigidTransform>& X_HL,
                                     const Solid& solid,
                                     const ContactParameters& parameters);

}  // namespace graspdb
