#include "engine/admission/mesh_repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/bbox.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/manifoldness.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_mesh_to_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/core.h>

#include "engine/admission/soup_cleaning.h"

namespace graspdb {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using SurfaceMesh = CGAL::Surface_mesh<Point>;
using Face = SurfaceMesh::Face_index;
using Halfedge = SurfaceMesh::Halfedge_index;

// A share of the diagonal cubed.
constexpr double kSmallestVolume = 1e-6;
// A shell whose caps have more than this share of its own area is a sheet.
constexpr double kMostCapArea = 0.75;
// What may be dropped: sheets by area, closed fragments by volume.
constexpr double kMostSheetArea = 0.02;
constexpr double kMostFragmentVolume = 0.02;
// Where that makes the box smaller by this share of the diagonal, wrapping is
// tried, which may reach what was dropped.
constexpr double kMostLostExtent = 0.01;
// Beyond this, mending step by step is slower than wrapping.
constexpr std::size_t kMostShells = 100;
// The cubes of the lengths, in edges, of all holes that are filled in the best
// way.
constexpr double kMostHoleWork = 1.5e7;
// Rounds of cutting crossing faces out, each with one more ring around them.
constexpr int kCuttingRounds = 5;

// A TriangleSoup of CGAL's points.
struct Soup {
  std::vector<Point> points;
  std::vector<TriangleSoup::Face> faces;
};

Soup ToSoup(const TriangleSoup& plain) {
  Soup soup{{}, plain.faces};
  for (const Eigen::Vector3d& p : plain.points) {
    soup.points.emplace_back(p.x(), p.y(), p.z());
  }
  return soup;
}

SurfaceMesh ToSurfaceMesh(const Soup& soup) {
  SurfaceMesh surface;
  pmp::polygon_soup_to_polygon_mesh(soup.points, soup.faces, surface);
  return surface;
}

TriangleSoup ToPlainSoup(const SurfaceMesh& surface) {
  Soup soup;
  pmp::polygon_mesh_to_polygon_soup(surface, soup.points, soup.faces);
  TriangleSoup plain{{}, std::move(soup.faces)};
  for (const Point& p : soup.points) {
    plain.points.emplace_back(p.x(), p.y(), p.z());
  }
  return plain;
}

TriangleMesh ToTriangleMesh(const SurfaceMesh& surface) {
  TriangleSoup soup = ToPlainSoup(surface);
  std::vector<Eigen::Vector3i> triangles;
  for (const auto& face : soup.faces) {
    triangles.emplace_back(face[0], face[1], face[2]);
  }
  return TriangleMesh(std::move(soup.points), std::move(triangles));
}

std::size_t CountShells(const SurfaceMesh& surface) {
  std::vector<std::size_t> shell(surface.num_faces() +
                                 surface.number_of_removed_faces());
  return pmp::connected_components(surface, CGAL::make_property_map(shell));
}

bool IsOneSolid(const SurfaceMesh& surface) {
  return surface.num_faces() > 0 && CGAL::is_closed(surface) &&
         CountShells(surface) == 1 && !pmp::does_self_intersect(surface);
}

// True when there is nothing to repair. @pre Every vertex is used.
bool IsSolid(const TriangleMesh& mesh) {
  if (!IsClosed(mesh)) return false;
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    if (mesh.area(f) == 0.0) return false;
  }
  if (CalcMassProperties(mesh).volume <=
      kSmallestVolume * std::pow(mesh.diagonal(), 3)) {
    return false;
  }
  const Soup soup = ToSoup(MakeSoup(mesh));
  return pmp::is_polygon_soup_a_polygon_mesh(soup.faces) &&
         IsOneSolid(ToSurfaceMesh(soup));
}

// Consistent winding; splits edges and vertices where more than two faces or
// one fan meet.
void Orient(Soup& soup, RepairLog& log) {
  const auto before = soup.faces;
  pmp::orient_polygon_soup(soup.points, soup.faces);
  std::size_t turned = 0;
  for (std::size_t f = 0; f < before.size(); ++f) {
    const auto& face = soup.faces[f];
    // Vertices may have been split: compare positions, not indices.
    const auto at = [&](std::size_t v) { return soup.points[v]; };
    const auto same = [&](int shift) {
      for (int k = 0; k < 3; ++k) {
        if (at(face[k]) != at(before[f][(k + shift) % 3])) return false;
      }
      return true;
    };
    if (!same(0) && !same(1) && !same(2)) ++turned;
  }
  log.Add("turned", turned, "face to agree with its neighbours",
          "faces to agree with their neighbours");
}

// ---- Shells: manifold, connected surfaces.

// Closes every hole in the best way, which takes the cube of its length at
// worst, as long as that is affordable; else by a fan about its middle.
// @returns the number of faces added.
std::size_t FillHoles(SurfaceMesh& shell, std::size_t* holes = nullptr) {
  std::vector<Halfedge> borders;
  pmp::extract_boundary_cycles(shell, std::back_inserter(borders));
  std::vector<Face> added;
  const std::size_t before = shell.num_faces();
  double work = 0.0;
  for (const Halfedge border : borders) {
    std::size_t length = 0;
    Kernel::Vector_3 sum = CGAL::NULL_VECTOR;
    for (const auto v : vertices_around_face(border, shell)) {
      ++length;
      sum += shell.point(v) - CGAL::ORIGIN;
    }
    const double cube = std::pow(static_cast<double>(length), 3);
    if (work + cube <= kMostHoleWork) {
      work += cube;
      pmp::triangulate_hole(shell, border, std::back_inserter(added));
    } else {
      CGAL::Euler::fill_hole(border, shell);
      const Halfedge spoke = CGAL::Euler::add_center_vertex(border, shell);
      shell.point(shell.target(spoke)) =
          CGAL::ORIGIN + sum / static_cast<double>(length);
    }
  }
  if (holes != nullptr) *holes += borders.size();
  return shell.num_faces() - before;
}

std::set<Face> FindCrossingFaces(const SurfaceMesh& shell) {
  std::vector<std::pair<Face, Face>> pairs;
  pmp::self_intersections(shell, std::back_inserter(pairs));
  std::set<Face> faces;
  for (const auto& [f, g] : pairs) faces.insert({f, g});
  return faces;
}

void AddRing(const SurfaceMesh& shell, std::set<Face>& faces) {
  std::set<Face> ring;
  for (const Face f : faces) {
    for (const Halfedge h : halfedges_around_face(shell.halfedge(f), shell)) {
      for (const Face g : faces_around_target(h, shell)) {
        if (g != SurfaceMesh::null_face()) ring.insert(g);
      }
    }
  }
  faces.merge(ring);
}

// Cuts faces that cross each other out of a closed shell and fills the gap, in
// wider and wider rings.
// @returns the number of faces cut; nothing when the shell resists.
std::optional<std::size_t> CutSelfIntersections(SurfaceMesh& shell) {
  std::size_t cut = 0;
  for (int round = 0; round < kCuttingRounds; ++round) {
    std::set<Face> faces = FindCrossingFaces(shell);
    if (faces.empty()) return cut;
    for (int ring = 0; ring < round; ++ring) AddRing(shell, faces);
    if (2 * faces.size() > shell.num_faces()) return std::nullopt;
    cut += faces.size();
    for (const Face f : faces) {
      CGAL::Euler::remove_face(shell.halfedge(f), shell);
    }
    shell.collect_garbage();
    pmp::duplicate_non_manifold_vertices(shell);
    pmp::keep_largest_connected_components(shell, 1);
    shell.collect_garbage();
    FillHoles(shell);
    if (!CGAL::is_closed(shell)) return std::nullopt;
  }
  return std::nullopt;
}

std::vector<SurfaceMesh> SplitShells(const SurfaceMesh& surface) {
  if (CountShells(surface) == 1) return {surface};
  std::vector<SurfaceMesh> shells;
  pmp::split_connected_components(surface, shells);
  return shells;
}

struct MendedShells {
  std::vector<SurfaceMesh> solids;
  std::vector<SurfaceMesh> sheets;  // No solids by themselves.
  double sheet_area{0.0};           // A share of the whole.
};

MendedShells MendShells(const std::vector<SurfaceMesh>& shells,
                        double smallest_volume, RepairLog& log) {
  MendedShells mended;
  std::size_t holes = 0;
  std::size_t added = 0;
  std::size_t cut = 0;
  std::size_t turned = 0;
  double area_of_all = 0.0;
  for (const SurfaceMesh& shell : shells) {
    SurfaceMesh solid = shell;
    const double area = pmp::area(shell);
    area_of_all += area;
    std::size_t holes_here = 0;
    const std::size_t added_here = FillHoles(solid, &holes_here);
    const bool is_sheet = !CGAL::is_closed(solid) ||
                          pmp::area(solid) > (1.0 + kMostCapArea) * area;
    SurfaceMesh filled = is_sheet ? shell : solid;
    const auto cut_here = is_sheet ? std::nullopt : CutSelfIntersections(solid);
    if (!cut_here || std::abs(pmp::volume(solid)) < smallest_volume) {
      mended.sheets.push_back(std::move(filled));
      mended.sheet_area += area;
      continue;
    }
    if (!pmp::is_outward_oriented(solid)) {
      pmp::reverse_face_orientations(solid);
      ++turned;
    }
    holes += holes_here;
    added += added_here;
    cut += *cut_here;
    mended.solids.push_back(std::move(solid));
  }
  mended.sheet_area /= area_of_all;
  if (holes > 0) {
    log.Add(fmt::format("filled {} with {}",
                        DescribeCount(holes, "hole", "holes"),
                        DescribeCount(added, "face", "faces")));
  }
  log.Add("cut out and filled", cut, "face that crossed others",
          "faces that crossed others");
  log.Add("turned", turned, "shell that was inside out",
          "shells that were inside out");
  return mended;
}

// The union of all; nothing when it is no manifold.
std::optional<SurfaceMesh> Unite(const std::vector<SurfaceMesh>& solids) {
  SurfaceMesh whole = solids.front();
  for (std::size_t i = 1; i < solids.size(); ++i) {
    SurfaceMesh other = solids[i];
    SurfaceMesh united;
    if (!pmp::corefine_and_compute_union(
            whole, other, united,
            CGAL::parameters::throw_on_self_intersection(true))) {
      return std::nullopt;
    }
    united.collect_garbage();
    whole = std::move(united);
  }
  if (!CutSelfIntersections(whole)) return std::nullopt;
  return whole;
}

// Keeps the largest piece when all others are fragments, else changes nothing.
// @returns whether one piece is left.
bool DropFragments(SurfaceMesh& surface, RepairLog& log) {
  std::vector<SurfaceMesh> pieces = SplitShells(surface);
  if (pieces.size() == 1) return true;
  std::vector<double> volumes;
  for (const SurfaceMesh& piece : pieces) {
    volumes.push_back(std::abs(pmp::volume(piece)));
  }
  const auto largest = std::max_element(volumes.begin(), volumes.end());
  const double share =
      1.0 - *largest / std::accumulate(volumes.begin(), volumes.end(), 0.0);
  if (share > kMostFragmentVolume) return false;
  surface = pieces[static_cast<std::size_t>(largest - volumes.begin())];
  log.Add(fmt::format(
      "dropped {} ({:.2g} % of the volume)",
      DescribeCount(pieces.size() - 1, "loose fragment", "loose fragments"),
      100.0 * share));
  return true;
}

// How far the surface's box falls short of the mesh's at most, m.
double CalcLostExtent(const SurfaceMesh& surface, const TriangleMesh& mesh) {
  const CGAL::Bbox_3 box = pmp::bbox(surface);
  double lost = 0.0;
  for (int i = 0; i < 3; ++i) {
    lost = std::max(
        {lost, box.min(i) - mesh.box_min()[i], mesh.box_max()[i] - box.max(i)});
  }
  return lost;
}

// One solid out of closed shells and sheets without wrapping, if that can be.
std::optional<SurfaceMesh> Assemble(const MendedShells& mended,
                                    RepairLog& log) {
  if (mended.solids.empty() || mended.sheet_area > kMostSheetArea) {
    return std::nullopt;
  }
  auto whole = Unite(mended.solids);
  if (!whole) return std::nullopt;
  if (mended.solids.size() > 1) {
    log.Add("united", mended.solids.size(), "shell", "shells");
  }
  log.Add("dropped", mended.sheets.size(), "small open sheet",
          "small open sheets");
  if (!DropFragments(*whole, log) || !IsOneSolid(*whole)) return std::nullopt;
  return whole;
}

Error MakeError(std::string message,
                std::string hint =
                    "Check the mesh in a mesh editor; a closed"
                    " surface is needed.") {
  return Error{ErrorCode::kUnusableInput, std::move(message), std::move(hint)};
}

struct Mended {
  SurfaceMesh solid;
  RepairLog log;
};

// Everything but wrapping; nothing when that makes no solid of it.
// @param rest  Receives what is to be wrapped in that case.
std::optional<Mended> Mend(Soup soup, double diagonal, RepairLog log,
                           Mended* rest) {
  Orient(soup, log);
  SurfaceMesh surface = ToSurfaceMesh(soup);
  log.Add("stitched", pmp::stitch_borders(surface), "pair of edges",
          "pairs of edges");
  *rest = {surface, log};
  if (CountShells(surface) > kMostShells) return std::nullopt;
  const MendedShells mended = MendShells(
      SplitShells(surface), kSmallestVolume * std::pow(diagonal, 3), log);
  *rest = {SurfaceMesh(), log};
  for (const auto* shells : {&mended.solids, &mended.sheets}) {
    for (const SurfaceMesh& shell : *shells) rest->solid.join(shell);
  }
  try {
    if (auto solid = Assemble(mended, log)) return Mended{*solid, log};
  } catch (const CGAL::Failure_exception&) {
    // A degeneracy that CGAL does not cope with.
  } catch (const pmp::Corefinement::Self_intersection_exception&) {
  }
  return std::nullopt;
}

Result<RepairedMesh> Repair(const TriangleMesh& mesh,
                            std::size_t most_wrap_points, RepairLog log) {
  const double diagonal = mesh.diagonal();
  const TriangleSoup soup = CleanSoup(mesh, log);
  if (soup.faces.empty()) {
    return MakeError("the mesh's faces have no area");
  }
  Mended rest;
  auto mended = Mend(ToSoup(soup), diagonal, log, &rest);
  if (!mended ||
      CalcLostExtent(mended->solid, mesh) > kMostLostExtent * diagonal) {
    Mended wrapped = std::move(rest);
    wrapped.solid = ToSurfaceMesh(ToSoup(WrapSurface(
        ToPlainSoup(wrapped.solid), diagonal, most_wrap_points, wrapped.log)));
    const bool in_one_piece = CountShells(wrapped.solid) == 1;
    if (!in_one_piece && !mended &&
        !DropFragments(wrapped.solid, wrapped.log)) {
      return MakeError(
          fmt::format("the mesh holds {} solids apart from each other",
                      CountShells(wrapped.solid)),
          "Send one object per file.");
    }
    if (in_one_piece || !mended) mended = std::move(wrapped);
  }
  if (!IsOneSolid(mended->solid) ||
      pmp::volume(mended->solid) < kSmallestVolume * std::pow(diagonal, 3)) {
    return MakeError("the mesh encloses no volume");
  }
  return RepairedMesh{ToTriangleMesh(mended->solid), mended->log.sentences()};
}

}  // namespace

Result<RepairedMesh> RepairMesh(const TriangleMesh& soup,
                                std::size_t most_wrap_points) {
  RepairLog log;
  const TriangleMesh mesh = DropUnusedVertices(soup, log);
  if (auto why = FindHopelessness(mesh)) return MakeError(*why);
  try {
    if (IsSolid(mesh)) return RepairedMesh{mesh, log.sentences()};
    return Repair(mesh, most_wrap_points, std::move(log));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return MakeError("no closed solid could be made of the mesh");
  }
}

}  // namespace graspdb
