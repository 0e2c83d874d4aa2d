#include "engine/quality/opposed_contacts.h"

#include <algorithm>

namespace graspdb {

bool HasOpposedPair(const std::vector<Eigen::Vector3d>& normals, int least) {
  const auto opposed =
      std::count_if(normals.begin(), normals.end(), [&](const auto& a) {
        return std::any_of(normals.begin(), normals.end(),
                           [&a](const auto& b) { return a.dot(b) < 0.0; });
      });
  return opposed >= least;
}

bool ReachesOpposedTargets(const std::vector<Contact>& contacts,
                           const std::vector<Contact>& targets,
                           double max_distance, int least) {
  std::vector<Eigen::Vector3d> reached;
  for (const Contact& target : targets) {
    const bool near = std::any_of(
        contacts.begin(), contacts.end(), [&](const Contact& contact) {
          return contact.link == target.link &&
                 (contact.p_O - target.p_O).norm() <= max_distance;
        });
    if (near) reached.push_back(target.nhat_O);
  }
  return HasOpposedPair(reached, least);
}

}  // namespace graspdb
