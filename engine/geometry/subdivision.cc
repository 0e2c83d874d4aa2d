#include "engine/geometry/subdivision.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace graspdb {

TriangleMesh Subdivide(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> vertices = mesh.vertices();
  std::vector<Eigen::Vector3i> triangles;
  std::map<std::pair<int, int>, int> middles;
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    Eigen::Vector3i m;
    for (int k = 0; k < 3; ++k) {
      const std::pair<int, int> edge = std::minmax({t[k], t[(k + 1) % 3]});
      const auto [it, fresh] =
          middles.try_emplace(edge, static_cast<int>(vertices.size()));
      if (fresh) {
        vertices.push_back(0.5 *
                           (vertices[edge.first] + vertices[edge.second]));
      }
      m[k] = it->second;
    }
    triangles.emplace_back(t[0], m[0], m[2]);
    triangles.emplace_back(m[0], t[1], m[1]);
    triangles.emplace_back(m[2], m[1], t[2]);
    triangles.push_back(m);
  }
  return TriangleMesh(std::move(vertices), std::move(triangles));
}

}  // namespace graspdb
