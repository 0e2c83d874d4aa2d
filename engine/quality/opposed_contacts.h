#pragma once

#include <vector>

#include "engine/quality/contact.h"

namespace graspdb {

/** True when at least so many of the normals oppose another one: more than a
 right angle apart. */
bool HasOpposedPair(const std::vector<Eigen::Vector3d>& normals, int least);

/** True when at least `least` targets that oppose each other are reached: a
 contact of the same link lies within max_distance of them.
 @param targets  Where contacts should be, with the object's normals there; gaps
   do not matter.
 @param max_distance  m. */
bool ReachesOpposedTargets(const std::vector<Contact>& contacts,
                           const std::vector<Contact>& targets,
                           double max_distance, int least);

}  // namespace graspdb
