#include "engine/geometry/surface_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <embree3/rtcore.h>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// Faces that meet at less than this belong to one plane.
constexpr double kFlatCosine = 1.0 - 1e-9;

// One device for the process: Embree's own advice. It holds no scene data. A
// limit on its threads would be one on TBB's in the whole process.
RTCDevice GetDevice() {
  static const RTCDevice device = rtcNewDevice(nullptr);
  return device;
}

// The feature of a triangle that a closest point lies on: its inside, one of
// its edges (k, k+1), or one of its corners.
enum class Feature {
  kFace,
  kEdge0,
  kEdge1,
  kEdge2,
  kCorner0,
  kCorner1,
  kCorner2
};

struct TrianglePoint {
  Eigen::Vector3d p;
  Feature feature;
};

// Ericson, Real-Time Collision Detection, 5.1.5.
TrianglePoint FindClosestOnTriangle(const Eigen::Vector3d& p,
                                    const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b,
                                    const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {a, Feature::kCorner0};
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {b, Feature::kCorner1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    return {a + ab * (d1 / (d1 - d3)), Feature::kEdge0};
  }
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {c, Feature::kCorner2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    return {a + ac * (d2 / (d2 - d6)), Feature::kEdge2};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {b + w * (c - b), Feature::kEdge1};
  }
  const double denominator = 1.0 / (va + vb + vc);
  return {a + ab * (vb * denominator) + ac * (vc * denominator),
          Feature::kFace};
}

double CalcCornerAngle(const TriangleMesh& mesh, int f, int k) {
  const Eigen::Vector3d u = mesh.corner(f, (k + 1) % 3) - mesh.corner(f, k);
  const Eigen::Vector3d v = mesh.corner(f, (k + 2) % 3) - mesh.corner(f, k);
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

}  // namespace

struct SurfaceIndex::Impl {
  TriangleMesh mesh;
  std::vector<Eigen::Vector3d> corner_normals;               // per vertex
  std::vector<std::array<Eigen::Vector3d, 3>> edge_normals;  // per face
  RTCScene scene{nullptr};

  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
  }

  void CalcPseudonormals() {
    corner_normals.assign(mesh.num_vertices(), Eigen::Vector3d::Zero());
    // Each side of each face: the edge's ends, the smaller first, and 3 f + k.
    std::vector<std::array<int, 3>> sides;
    sides.reserve(3 * mesh.triangles().size());
    for (int f = 0; f < mesh.num_triangles(); ++f) {
      const Eigen::Vector3i& t = mesh.triangles()[f];
      for (int k = 0; k < 3; ++k) {
        corner_normals[t[k]] += CalcCornerAngle(mesh, f, k) * mesh.normal(f);
        const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
        sides.push_back({low, high, 3 * f + k});
      }
    }
    for (Eigen::Vector3d& n : corner_normals) n.normalize();
    std::sort(sides.begin(), sides.end());
    edge_normals.resize(mesh.num_triangles());
    for (auto begin = sides.begin(); begin != sides.end();) {
      const auto end = std::find_if(begin, sides.end(), [&](const auto& side) {
        return side[0] != (*begin)[0] || side[1] != (*begin)[1];
      });
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (auto side = begin; side != end; ++side) {
        sum += mesh.normal((*side)[2] / 3);
      }
      sum.normalize();
      for (; begin != end; ++begin) {
        edge_normals[(*begin)[2] / 3][(*begin)[2] % 3] = sum;
      }
    }
  }

  Eigen::Vector3d CalcPseudonormal(int f, Feature feature) const {
    switch (feature) {
      case Feature::kFace:
        return mesh.normal(f);
      case Feature::kEdge0:
        return edge_normals[f][0];
      case Feature::kEdge1:
        return edge_normals[f][1];
      case Feature::kEdge2:
        return edge_normals[f][2];
      case Feature::kCorner0:
        return corner_normals[mesh.triangles()[f][0]];
      case Feature::kCorner1:
        return corner_normals[mesh.triangles()[f][1]];
      case Feature::kCorner2:
        return corner_normals[mesh.triangles()[f][2]];
    }
    return mesh.normal(f);
  }
};

namespace {

struct QueryState {
  const TriangleMesh* mesh;
  Eigen::Vector3d p;
  double best_squared;
  int face{-1};
  TrianglePoint point{};
};

bool VisitTriangle(RTCPointQueryFunctionArguments* arguments) {
  auto& state = *static_cast<QueryState*>(arguments->userPtr);
  const int f = static_cast<int>(arguments->primID);
  const TrianglePoint candidate =
      FindClosestOnTriangle(state.p, state.mesh->corner(f, 0),
                            state.mesh->corner(f, 1), state.mesh->corner(f, 2));
  const double squared = (state.p - candidate.p).squaredNorm();
  if (squared > state.best_squared ||
      (squared == state.best_squared && state.face >= 0 && f > state.face)) {
    return false;
  }
  state.best_squared = squared;
  state.face = f;
  state.point = candidate;
  // Embree prunes in single precision: leave it a margin for rounding.
  const auto radius =
      static_cast<float>(std::sqrt(squared) * (1.0 + 1e-5) + 1e-7);
  if (radius < arguments->query->radius) {
    arguments->query->radius = radius;
    return true;
  }
  return false;
}

}  // namespace

SurfaceIndex::SurfaceIndex(const TriangleMesh& mesh_M)
    : impl_(std::make_unique<Impl>()) {
  impl_->mesh = mesh_M;
  impl_->CalcPseudonormals();
  impl_->scene = rtcNewScene(GetDevice());
  const RTCGeometry geometry =
      rtcNewGeometry(GetDevice(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
      mesh_M.vertices().size()));
  for (const Eigen::Vector3d& p : mesh_M.vertices()) {
    for (int k = 0; k < 3; ++k) *vertices++ = static_cast<float>(p[k]);
  }
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
      3 * sizeof(unsigned), mesh_M.triangles().size()));
  for (const Eigen::Vector3i& t : mesh_M.triangles()) {
    for (int k = 0; k < 3; ++k) *indices++ = static_cast<unsigned>(t[k]);
  }
  rtcSetGeometryPointQueryFunction(geometry, VisitTriangle);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(impl_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(impl_->scene);
}

SurfaceIndex::~SurfaceIndex() = default;
SurfaceIndex::SurfaceIndex(SurfaceIndex&&) noexcept = default;
SurfaceIndex& SurfaceIndex::operator=(SurfaceIndex&&) noexcept = default;

std::optional<ClosestPoint> SurfaceIndex::FindClosest(
    const Eigen::Vector3d& p_M, double max_distance) const {
  QueryState state{&impl_->mesh, p_M, max_distance * max_distance};
  RTCPointQuery query;
  query.x = static_cast<float>(p_M.x());
  query.y = static_cast<float>(p_M.y());
  query.z = static_cast<float>(p_M.z());
  query.time = 0.0F;
  query.radius = static_cast<float>(max_distance * (1.0 + 1e-5) + 1e-6);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(impl_->scene, &query, &context, nullptr, &state);
  if (state.face < 0) return std::nullopt;
  const Eigen::Vector3d pseudonormal =
      impl_->CalcPseudonormal(state.face, state.point.feature);
  const bool on_face =
      state.point.feature == Feature::kFace ||
      pseudonormal.dot(impl_->mesh.normal(state.face)) > kFlatCosine;
  return ClosestPoint{std::sqrt(state.best_squared), state.point.p, state.face,
                      pseudonormal, on_face};
}

double SurfaceIndex::CalcSignedDistance(const Eigen::Vector3d& p_M) const {
  const std::optional<ClosestPoint> closest = FindClosest(p_M);
  GRASPDB_EXPECTS(closest.has_value());
  const bool outside = (p_M - closest->p_M).dot(closest->pseudonormal) >= 0.0;
  return outside ? closest->distance : -closest->distance;
}

}  // namespace graspdb
