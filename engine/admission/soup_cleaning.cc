#include "engine/admission/soup_cleaning.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>

#include <fmt/core.h>
#include <Eigen/Geometry>

namespace graspdb {
namespace {

using Face = TriangleSoup::Face;
using Edge = std::pair<std::size_t, std::size_t>;

// Lengths as shares of the diagonal of the soup's box.
constexpr double kWeldDistance = 1e-5;      // Also for T-junctions.
constexpr double kDegenerateHeight = 1e-8;  // A triangle's smallest height.
constexpr double kPlanarThickness = 1e-4;
// Beyond this, mending step by step is slower than wrapping.
constexpr std::size_t kMostBorderEdges = 20'000;

// The distance that the points keep from their best plane, roughly: through the
// first point, the one farthest from it, and the one farthest from their line.
double CalcThickness(const std::vector<Eigen::Vector3d>& points) {
  const auto farthest = [&points](const auto& distance) {
    Eigen::Vector3d best = points.front();
    for (const Eigen::Vector3d& p : points) {
      if (distance(p) > distance(best)) best = p;
    }
    return best;
  };
  const Eigen::Vector3d a = points.front();
  const Eigen::Vector3d b = farthest(
      [&a](const Eigen::Vector3d& p) { return (p - a).squaredNorm(); });
  const Eigen::Vector3d axis = (b - a).normalized();
  const Eigen::Vector3d c = farthest([&](const Eigen::Vector3d& p) {
    return axis.cross(p - a).squaredNorm();
  });
  const Eigen::Vector3d normal = axis.cross(c - a).normalized();
  const auto height = [&](const Eigen::Vector3d& p) {
    return std::abs(normal.dot(p - a));
  };
  return height(farthest(height));
}

Edge MakeEdge(std::size_t a, std::size_t b) { return std::minmax(a, b); }

// The edges that belong to one face only, sorted.
std::vector<Edge> FindBorderEdges(const TriangleSoup& soup) {
  std::vector<Edge> edges;
  for (const auto& face : soup.faces) {
    for (int k = 0; k < 3; ++k) {
      edges.push_back(MakeEdge(face[k], face[(k + 1) % 3]));
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<Edge> border;
  for (auto it = edges.begin(); it != edges.end();) {
    const auto next = std::upper_bound(it, edges.end(), *it);
    if (next - it == 1) border.push_back(*it);
    it = next;
  }
  return border;
}

// For each vertex at an open edge, the first such one within the distance: by a
// grid of cells wider than it, so that few have to look into a second cell.
// Vertices inside a closed surface stay apart, as in two parts that touch.
std::vector<std::size_t> FindWelds(const TriangleMesh& mesh,
                                   const TriangleSoup& soup, double distance) {
  std::vector<bool> is_open(soup.points.size(), false);
  for (const auto& [a, b] : FindBorderEdges(soup)) {
    is_open[a] = is_open[b] = true;
  }
  const double cell = 8.0 * distance;
  std::unordered_map<uint64_t, std::vector<std::size_t>> grid;
  std::vector<std::size_t> weld(soup.points.size());
  std::iota(weld.begin(), weld.end(), 0);
  for (std::size_t i = 0; i < weld.size(); ++i) {
    if (!is_open[i]) continue;
    const Eigen::Vector3d p = mesh.vertices()[i] - mesh.box_min();
    const auto key = [&](double dx, double dy, double dz) {
      const auto index = [cell](double x) {
        return static_cast<uint64_t>(std::max(0.0, x) / cell);
      };
      return index(p.x() + dx) << 42 | index(p.y() + dy) << 21 |
             index(p.z() + dz);
    };
    for (int corner = 0; corner < 8 && weld[i] == i; ++corner) {
      const auto found = grid.find(key(corner & 1 ? distance : -distance,
                                       corner & 2 ? distance : -distance,
                                       corner & 4 ? distance : -distance));
      if (found == grid.end()) continue;
      for (const std::size_t j : found->second) {
        if ((mesh.vertices()[j] - mesh.vertices()[i]).norm() <= distance) {
          weld[i] = j;
          break;
        }
      }
    }
    if (weld[i] == i) grid[key(0, 0, 0)].push_back(i);
  }
  return weld;
}

double CalcSmallestHeight(const TriangleSoup& soup, const Face& face) {
  const Eigen::Vector3d a = soup.points[face[0]];
  const Eigen::Vector3d b = soup.points[face[1]];
  const Eigen::Vector3d c = soup.points[face[2]];
  const double longest =
      std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return longest > 0.0 ? (b - a).cross(c - a).norm() / longest : 0.0;
}

// Welds, drops degenerate and duplicate faces and what no face uses. In a
// closed surface a face without height does its duty and stays.
TriangleSoup WeldAndDrop(const TriangleMesh& mesh, RepairLog& log) {
  const TriangleSoup all = MakeSoup(mesh);
  const bool closed = IsClosed(mesh);
  const std::vector<std::size_t> weld =
      FindWelds(mesh, all, kWeldDistance * mesh.diagonal());
  std::set<Face> seen;
  std::vector<Face> faces;
  std::size_t degenerate = 0;
  std::size_t duplicate = 0;
  for (Face face : all.faces) {
    for (std::size_t& v : face) v = weld[v];
    const bool collapsed =
        face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
    if (collapsed || (!closed && CalcSmallestHeight(all, face) <=
                                     kDegenerateHeight * mesh.diagonal())) {
      ++degenerate;
      continue;
    }
    Face corners = face;
    std::sort(corners.begin(), corners.end());
    if (seen.insert(corners).second) {
      faces.push_back(face);
    } else {
      ++duplicate;
    }
  }
  std::vector<bool> used(all.points.size(), false);
  for (const auto& face : faces) {
    for (const std::size_t v : face) used[v] = true;
  }
  TriangleSoup soup;
  std::size_t welded = 0;
  std::vector<std::size_t> index(all.points.size());
  for (std::size_t v = 0; v < all.points.size(); ++v) {
    index[v] = soup.points.size();
    if (used[v]) soup.points.push_back(all.points[v]);
    if (weld[v] != v) ++welded;
  }
  for (const auto& face : faces) {
    soup.faces.push_back({index[face[0]], index[face[1]], index[face[2]]});
  }
  log.Add("welded", welded, "vertex", "vertices");
  log.Add("dropped", degenerate, "degenerate face", "degenerate faces");
  log.Add("dropped", duplicate, "duplicate face", "duplicate faces");
  return soup;
}

// The border vertices that lie within the distance of a border edge's inside,
// in order from the edge's first vertex to its second.
std::map<Edge, std::vector<std::size_t>> FindTJunctions(
    const TriangleSoup& soup, double distance) {
  std::map<Edge, std::vector<std::size_t>> junctions;
  const std::vector<Edge> border = FindBorderEdges(soup);
  if (border.size() > kMostBorderEdges) return junctions;
  std::set<std::size_t> border_vertices;
  for (const Edge& edge : border) {
    border_vertices.insert({edge.first, edge.second});
  }
  std::vector<std::pair<double, std::size_t>> by_x;
  for (const std::size_t v : border_vertices) {
    by_x.emplace_back(soup.points[v].x(), v);
  }
  std::sort(by_x.begin(), by_x.end());
  for (const Edge& edge : border) {
    const Eigen::Vector3d a = soup.points[edge.first];
    const Eigen::Vector3d b = soup.points[edge.second];
    const double length = (b - a).norm();
    const Eigen::Vector3d direction = (b - a) / length;
    std::vector<std::pair<double, std::size_t>> inside;
    const double end = std::max(a.x(), b.x()) + distance;
    for (auto it = std::lower_bound(
             by_x.begin(), by_x.end(),
             std::pair(std::min(a.x(), b.x()) - distance, std::size_t{0}));
         it != by_x.end() && it->first <= end; ++it) {
      const Eigen::Vector3d to_v = soup.points[it->second] - a;
      const double along = direction.dot(to_v);
      if (along > distance && along < length - distance &&
          (to_v - along * direction).norm() <= distance) {
        inside.emplace_back(along, it->second);
      }
    }
    std::sort(inside.begin(), inside.end());
    for (const auto& [along, v] : inside) junctions[edge].push_back(v);
  }
  return junctions;
}

// Cuts faces so that no vertex lies inside another face's border edge.
void SplitAtTJunctions(TriangleSoup& soup, double distance, RepairLog& log) {
  auto junctions = FindTJunctions(soup, distance);
  log.Add("split", junctions.size(), "edge at T-junctions",
          "edges at T-junctions");
  std::vector<Face> faces;
  for (const auto& whole : soup.faces) {
    std::vector<Face> work{whole};
    while (!work.empty()) {
      const auto face = work.back();
      work.pop_back();
      int k = 0;
      auto found = junctions.end();
      for (; k < 3 && found == junctions.end(); ++k) {
        found = junctions.find(MakeEdge(face[k], face[(k + 1) % 3]));
      }
      if (found == junctions.end()) {
        faces.push_back(face);
        continue;
      }
      // Split at the edge's first vertex; what is left of the edge inherits the
      // others, again in order from its smaller index on.
      const std::size_t v = found->second.front();
      const std::size_t end = found->first.second;
      std::vector<std::size_t> others(found->second.begin() + 1,
                                      found->second.end());
      junctions.erase(found);
      if (v > end) std::reverse(others.begin(), others.end());
      if (!others.empty()) junctions[MakeEdge(v, end)] = std::move(others);
      const std::size_t a = face[k - 1];
      const std::size_t b = face[k % 3];
      const std::size_t c = face[(k + 1) % 3];
      if (v == c) continue;  // The face is a sliver along its own edge.
      work.push_back({v, b, c});
      work.push_back({a, v, c});
    }
  }
  soup.faces = std::move(faces);
}

}  // namespace

std::string DescribeCount(std::size_t count, const char* one,
                          const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

void RepairLog::Add(const char* verb, std::size_t count, const char* one,
                    const char* many) {
  if (count == 0) return;
  Add(std::string(verb) + " " + DescribeCount(count, one, many));
}

TriangleSoup MakeSoup(const TriangleMesh& mesh) {
  TriangleSoup soup;
  soup.points = mesh.vertices();
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    soup.faces.push_back({static_cast<std::size_t>(t[0]),
                          static_cast<std::size_t>(t[1]),
                          static_cast<std::size_t>(t[2])});
  }
  return soup;
}

TriangleMesh DropUnusedVertices(const TriangleMesh& mesh, RepairLog& log) {
  std::vector<int> index(mesh.vertices().size(), -1);
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    for (const int v : t) index[v] = 0;
  }
  std::vector<Eigen::Vector3d> vertices;
  for (std::size_t v = 0; v < index.size(); ++v) {
    if (index[v] < 0) continue;
    index[v] = static_cast<int>(vertices.size());
    vertices.push_back(mesh.vertices()[v]);
  }
  log.Add("dropped", index.size() - vertices.size(), "unused vertex",
          "unused vertices");
  std::vector<Eigen::Vector3i> triangles;
  for (const Eigen::Vector3i& t : mesh.triangles()) {
    triangles.emplace_back(index[t[0]], index[t[1]], index[t[2]]);
  }
  return TriangleMesh(std::move(vertices), std::move(triangles));
}

std::optional<std::string> FindHopelessness(const TriangleMesh& mesh) {
  if (mesh.num_triangles() == 0) return "the mesh has no faces";
  for (const Eigen::Vector3d& p : mesh.vertices()) {
    if (!p.allFinite()) return "the mesh has a coordinate that is not finite";
  }
  const double diagonal = mesh.diagonal();
  if (!(mesh.total_area() > kDegenerateHeight * diagonal * diagonal)) {
    return "the mesh's faces have no area";
  }
  if (CalcThickness(mesh.vertices()) < kPlanarThickness * diagonal) {
    return "all points of the mesh lie in one plane";
  }
  return std::nullopt;
}

TriangleSoup CleanSoup(const TriangleMesh& mesh, RepairLog& log) {
  TriangleSoup soup = WeldAndDrop(mesh, log);
  SplitAtTJunctions(soup, kWeldDistance * mesh.diagonal(), log);
  return soup;
}

}  // namespace graspdb
