#include "engine/segmentation/part_cutting.h"

#include <algorithm>
#include <map>
#include <utility>

#include "engine/base/contract.h"
#include "engine/segmentation/loop_filling.h"

namespace graspdb {
namespace {

// Longer loops are closed by a fan: the exact filling takes cubic time.
constexpr int kMaxExactLoop = 400;

using Edge = std::pair<int, int>;

// Every edge in both directions, sorted.
std::vector<Edge> ListEdges(const TriangleMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(6 * mesh.triangles().size());
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    for (int k = 0; k < 3; ++k) {
      edges.emplace_back(t[k], t[(k + 1) % 3]);
      edges.emplace_back(t[(k + 1) % 3], t[k]);
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// A part under construction: the faces of one label, then caps.
class PartBuilder {
 public:
  PartBuilder(const LabelledMesh& object, const std::vector<Edge>& object_edges,
              int label)
      : mesh_(object.mesh_O), object_edges_(object_edges) {
    part_.label = label;
    for (int f = 0; f < mesh_.num_triangles(); ++f) {
      if (object.face_labels[f] == label) part_.object_faces.push_back(f);
    }
    part_.num_surface_faces = static_cast<int>(part_.object_faces.size());
  }

  bool is_empty() const { return part_.num_surface_faces == 0; }

  Part Build() {
    AddSurface();
    for (const std::vector<int>& loop : TakeHoles()) Fill(loop);
    part_.solid_O = TriangleMesh(std::move(vertices_), std::move(triangles_));
    return std::move(part_);
  }

 private:
  // Copies the faces and notes their border. Where two fans of faces touch in
  // one vertex only, each fan gets its own copy of it, so that every border is
  // a simple loop.
  void AddSurface() {
    const int num_corners = 3 * part_.num_surface_faces;
    std::vector<int> parents(num_corners);
    for (int c = 0; c < num_corners; ++c) parents[c] = c;
    const auto find_root = [&parents](int c) {
      while (parents[c] != c) c = parents[c] = parents[parents[c]];
      return c;
    };
    const auto unite = [&](int a, int b) {
      const auto [low, high] = std::minmax({find_root(a), find_root(b)});
      parents[high] = low;
    };
    // Corners meet along an edge that two faces of the part share.
    std::map<Edge, int> side_of;  // The corner at which a directed edge starts.
    for (int c = 0; c < num_corners; ++c) {
      side_of[{ObjectVertex(c), ObjectVertex(Next(c))}] = c;
    }
    std::vector<int> border;
    for (const auto& [edge, c] : side_of) {
      const auto other = side_of.find({edge.second, edge.first});
      if (other == side_of.end()) {
        border.push_back(c);
      } else {
        unite(c, Next(other->second));
        unite(Next(c), other->second);
      }
    }
    std::vector<int> vertex_of(num_corners, -1);
    for (int c = 0; c < num_corners; ++c) {
      const int root = find_root(c);
      if (vertex_of[root] < 0) {
        vertex_of[root] = static_cast<int>(vertices_.size());
        vertices_.push_back(mesh_.vertices()[ObjectVertex(c)]);
        object_vertices_.push_back(ObjectVertex(c));
      }
      vertex_of[c] = vertex_of[root];
    }
    for (int c = 0; c < num_corners; c += 3) {
      triangles_.emplace_back(vertex_of[c], vertex_of[c + 1], vertex_of[c + 2]);
    }
    for (const int c : border) next_[vertex_of[Next(c)]] = vertex_of[c];
  }

  int ObjectVertex(int corner) const {
    return mesh_.triangles()[part_.object_faces[corner / 3]][corner % 3];
  }
  static int Next(int corner) {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
  }

  // Loops in the direction in which cap faces must run through them.
  std::vector<std::vector<int>> TakeHoles() {
    std::vector<std::vector<int>> loops;
    while (!next_.empty()) {
      std::vector<int>& loop = loops.emplace_back();
      for (auto at = next_.begin(); at != next_.end();
           at = next_.find(loop.back())) {
        loop.push_back(at->second);
        next_.erase(at);
      }
    }
    return loops;
  }

  void Fill(const std::vector<int>& loop) {
    const int n = static_cast<int>(loop.size());
    std::vector<Eigen::Vector3d> points;
    for (const int vertex : loop) points.push_back(vertices_[vertex]);
    // A chord along an edge of this part would give that edge a third face; one
    // along an edge of another part would make the two caps of a cut differ.
    const auto is_edge = [&](int i, int j) {
      return std::binary_search(
          object_edges_.begin(), object_edges_.end(),
          Edge(object_vertices_[loop[i]], object_vertices_[loop[j]]));
    };
    const auto caps =
        n > kMaxExactLoop ? std::nullopt : FillLoop(points, is_edge);
    if (caps) {
      for (const Eigen::Vector3i& t : *caps) {
        triangles_.emplace_back(loop[t[0]], loop[t[1]], loop[t[2]]);
      }
      return;
    }
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : points) centre += p / n;
    const int apex = static_cast<int>(vertices_.size());
    vertices_.push_back(centre);
    for (int i = 0; i < n; ++i) {
      triangles_.emplace_back(loop[i], loop[(i + 1) % n], apex);
    }
  }

  const TriangleMesh& mesh_;
  const std::vector<Edge>& object_edges_;
  Part part_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<int> object_vertices_;  // Of each vertex but the caps' own.
  std::vector<Eigen::Vector3i> triangles_;
  std::map<int, int> next_;  // Along the border, against the faces.
};

}  // namespace

Result<std::vector<Part>> CutIntoParts(const LabelledMesh& object,
                                       const PartVocabulary& vocabulary) {
  const int num_labels = static_cast<int>(vocabulary.labels.size());
  GRASPDB_EXPECTS(static_cast<int>(object.face_labels.size()) ==
                  object.mesh_O.num_triangles());
  for (const int label : object.face_labels) {
    GRASPDB_EXPECTS(label >= 0 && label < num_labels);
  }
  const std::vector<Edge> edges = ListEdges(object.mesh_O);
  std::vector<Part> parts;
  for (int label = 0; label < num_labels; ++label) {
    PartBuilder builder(object, edges, label);
    if (builder.is_empty()) continue;
    Part part = builder.Build();
    if (!IsClosed(part.solid_O) ||
        CalcMassProperties(part.solid_O).volume <= 0.0) {
      return Error{ErrorCode::kUnusableInput,
                   "the part '" + vocabulary.labels[label] +
                       "' cannot be closed to a solid",
                   "label larger, connected regions of faces"};
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace graspdb
