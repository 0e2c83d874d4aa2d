#include "engine/segmentation/face_graph.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// The angle by which the surface bends over an edge, negative when it is a
// valley: the far corner of face b then lies above face a.
double CalcBend(const TriangleMesh& mesh, int a, int b) {
  const Eigen::Vector3d& normal_a = mesh.normal(a);
  const Eigen::Vector3d& normal_b = mesh.normal(b);
  const double angle =
      std::atan2(normal_a.cross(normal_b).norm(), normal_a.dot(normal_b));
  const double height = normal_a.dot(mesh.centroid(b) - mesh.centroid(a));
  return height > 0.0 ? -angle : angle;
}

int FindRoot(std::vector<int>& parents, int i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

std::vector<FaceLink> CalcFaceLinks(const TriangleMesh& mesh) {
  // (smaller vertex, larger vertex, face), sorted: neighbours are adjacent.
  std::vector<std::tuple<int, int, int>> sides;
  sides.reserve(3 * mesh.triangles().size());
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    const Eigen::Vector3i& t = mesh.triangles()[f];
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({t[k], t[(k + 1) % 3]});
      sides.emplace_back(low, high, f);
    }
  }
  std::sort(sides.begin(), sides.end());
  std::vector<FaceLink> links;
  links.reserve(sides.size() / 2);
  for (size_t i = 1; i < sides.size(); ++i) {
    const auto& [low, high, a] = sides[i - 1];
    const auto& [next_low, next_high, b] = sides[i];
    if (low != next_low || high != next_high) continue;
    links.push_back({a, b,
                     (mesh.vertices()[high] - mesh.vertices()[low]).norm(),
                     CalcBend(mesh, a, b)});
  }
  std::stable_sort(
      links.begin(), links.end(),
      [](const auto& a, const auto& b) { return a.face_a < b.face_a; });
  return links;
}

std::vector<int> CalcComponents(const std::vector<int>& face_labels,
                                const std::vector<FaceLink>& links) {
  const int num_faces = static_cast<int>(face_labels.size());
  std::vector<int> parents(num_faces);
  for (int f = 0; f < num_faces; ++f) parents[f] = f;
  for (const FaceLink& link : links) {
    if (face_labels[link.face_a] != face_labels[link.face_b]) continue;
    const auto [low, high] = std::minmax(
        {FindRoot(parents, link.face_a), FindRoot(parents, link.face_b)});
    parents[high] = low;  // The root is the component's first face.
  }
  std::vector<int> components(num_faces);
  int count = 0;
  for (int f = 0; f < num_faces; ++f) {
    const int root = FindRoot(parents, f);
    components[f] = root == f ? count++ : components[root];
  }
  return components;
}

std::vector<int> MergeIslands(const TriangleMesh& mesh,
                              const std::vector<FaceLink>& links,
                              std::vector<int> face_labels, double min_share) {
  GRASPDB_EXPECTS(min_share >= 0.0 && min_share < 1.0);
  // Each pass relabels the smallest island, so that islands beside islands do
  // not swap; a pass removes one component, so this ends.
  while (true) {
    const std::vector<int> components = CalcComponents(face_labels, links);
    std::map<int, double> label_area;
    std::map<int, double> component_area;
    for (int f = 0; f < mesh.num_triangles(); ++f) {
      label_area[face_labels[f]] += mesh.area(f);
      component_area[components[f]] += mesh.area(f);
    }
    int smallest = -1;
    for (int f = 0; f < mesh.num_triangles(); ++f) {
      const int c = components[f];
      const bool is_island =
          component_area[c] < min_share * label_area[face_labels[f]];
      if (is_island &&
          (smallest < 0 || component_area[c] < component_area[smallest])) {
        smallest = c;
      }
    }
    std::map<int, double> border;
    for (const FaceLink& link : links) {
      const auto [a, b] = std::pair(link.face_a, link.face_b);
      if ((components[a] == smallest) == (components[b] == smallest)) continue;
      border[face_labels[components[a] == smallest ? b : a]] += link.length;
    }
    if (smallest < 0 || border.empty()) return face_labels;
    const int label =
        std::max_element(border.begin(), border.end(), [](auto& a, auto& b) {
          return a.second < b.second;
        })->first;
    for (int f = 0; f < mesh.num_triangles(); ++f) {
      if (components[f] == smallest) face_labels[f] = label;
    }
  }
}

}  // namespace graspdb
