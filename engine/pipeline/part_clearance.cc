#include "engine/pipeline/part_clearance.h"

#include <algorithm>
#include <limits>

#include "engine/base/contract.h"

namespace graspdb {

PartSurfaces::PartSurfaces(const LabelledMesh& object) {
  const std::vector<int>& labels = object.face_labels;
  if (labels.empty()) return;
  GRASPDB_EXPECTS(std::ssize(labels) == object.mesh_O.num_triangles());
  const int count = *std::max_element(labels.begin(), labels.end()) + 1;
  for (int label = 0; label < count; ++label) {
    std::vector<Eigen::Vector3i> triangles;
    for (size_t f = 0; f < labels.size(); ++f) {
      if (labels[f] == label) triangles.push_back(object.mesh_O.triangles()[f]);
    }
    surfaces_.emplace_back();
    if (triangles.empty()) continue;
    surfaces_.back().emplace(
        TriangleMesh(object.mesh_O.vertices(), std::move(triangles)));
  }
}

std::vector<double> PartSurfaces::CalcClearances(
    const HandShape& hand, const HandConfiguration& configuration) const {
  const auto X_HL = CalcLinkPoses(hand.model(), configuration.q);
  std::vector<double> clearances;
  for (const std::optional<CollisionShape>& surface : surfaces_) {
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t i = 0; surface && i < X_HL.size(); ++i) {
      const auto& link = hand.link(static_cast<int>(i));
      if (!link) continue;
      nearest = std::min(
          nearest,
          surface->CalcDistance(link->shape, configuration.X_OH * X_HL[i]));
    }
    clearances.push_back(nearest);
  }
  return clearances;
}

bool KeepsFree(const std::vector<double>& clearances,
               const std::vector<int>& labels, double min_clearance) {
  return std::all_of(labels.begin(), labels.end(), [&](int label) {
    const auto i = static_cast<size_t>(label);
    return i >= clearances.size() || clearances[i] >= min_clearance;
  });
}

}  // namespace graspdb
