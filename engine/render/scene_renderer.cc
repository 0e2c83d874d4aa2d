#include "engine/render/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <embree3/rtcore.h>

#include "engine/base/contract.h"
#include "engine/base/parallel.h"
#include "engine/math/rigid_transform.h"

namespace graspdb {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kHalfViewAngle = 0.20;  // rad, vertically or horizontally.
constexpr double kFrameShare = 0.94;     // Of the picture that is filled.
constexpr double kSmoothAngle = 0.70;    // rad; sharper edges stay edges.
constexpr float kKeyLight = 0.80F;       // Irradiance shares, linear.
constexpr float kFillLight = 0.10F;
constexpr float kAmbientLight = 0.34F;
constexpr float kKeyRadius = 0.16F;  // Of the soft key light, rad.
constexpr int kAmbientRaysPerRay = 3;
constexpr double kAmbientReach = 0.45;  // Of the scene's diagonal.
const Vector3f kBackgroundTop(0.97F, 0.975F, 0.98F);     // sRGB
const Vector3f kBackgroundBottom(0.88F, 0.89F, 0.905F);  // sRGB

float ToLinear(float srgb) {
  return srgb <= 0.04045F ? srgb / 12.92F
                          : std::pow((srgb + 0.055F) / 1.055F, 2.4F);
}

float ToSrgb(float linear) {
  return linear <= 0.0031308F ? linear * 12.92F
                              : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

// All items in one list of triangles, ready for shading.
struct Triangles {
  std::vector<Vector3f> corners;  // Three per triangle.
  std::vector<Vector3f> normals;  // Three per triangle, for smooth shading.
  std::vector<Vector3f> colours;  // One per triangle, linear.
};

// One normal per corner: the mean over the faces at that vertex which meet this
// face at less than kSmoothAngle, weighted by area.
std::vector<Vector3d> CalcCornerNormals(const TriangleMesh& mesh) {
  std::vector<std::vector<int>> faces_at(mesh.num_vertices());
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    for (int k = 0; k < 3; ++k) faces_at[mesh.triangles()[f][k]].push_back(f);
  }
  const double min_cosine = std::cos(kSmoothAngle);
  std::vector<Vector3d> normals;
  normals.reserve(3 * static_cast<size_t>(mesh.num_triangles()));
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    for (int k = 0; k < 3; ++k) {
      Vector3d sum = Vector3d::Zero();
      for (int g : faces_at[mesh.triangles()[f][k]]) {
        if (mesh.normal(f).dot(mesh.normal(g)) > min_cosine) {
          sum += mesh.area(g) * mesh.normal(g);
        }
      }
      normals.push_back(sum.squaredNorm() > 0 ? sum.normalized()
                                              : mesh.normal(f));
    }
  }
  return normals;
}

// Faces without area are left out: they show nothing, and embree must not see
// a normal that is no number.
Triangles CollectTriangles(const std::vector<RenderItem>& items) {
  Triangles all;
  for (const RenderItem& item : items) {
    const TriangleMesh& mesh = item.mesh_O;
    GRASPDB_EXPECTS(item.colours.size() == 1 ||
                    static_cast<int>(item.colours.size()) ==
                        mesh.num_triangles());
    const std::vector<Vector3d> normals = CalcCornerNormals(mesh);
    for (int f = 0; f < mesh.num_triangles(); ++f) {
      if (mesh.area(f) <= 0) continue;
      for (int k = 0; k < 3; ++k) {
        all.corners.push_back(mesh.corner(f, k).cast<float>());
        all.normals.push_back(normals[3 * f + k].cast<float>());
      }
      const Rgb& c = item.colours[item.colours.size() == 1 ? 0 : f];
      all.colours.emplace_back(ToLinear(c.r), ToLinear(c.g), ToLinear(c.b));
    }
  }
  return all;
}

struct Hit {
  int triangle;
  float distance;
  float u;
  float v;
};

// Owns embree's scene. One thread builds it, so that the tree, and with it the
// answer to a tie, is always the same.
class RayCaster {
 public:
  explicit RayCaster(const std::vector<Vector3f>& corners)
      : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
        3 * sizeof(float), corners.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
        3 * sizeof(unsigned), corners.size() / 3));
    for (size_t i = 0; i < corners.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        vertices[3 * i + axis] = corners[i][axis];
      }
      indices[i] = static_cast<unsigned>(i);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene_);
  }
  ~RayCaster() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  std::optional<Hit> FindFirst(const Vector3f& origin,
                               const Vector3f& direction) const {
    RTCRayHit query{};
    query.ray =
        MakeRay(origin, direction, std::numeric_limits<float>::infinity());
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return Hit{static_cast<int>(query.hit.primID), query.ray.tfar, query.hit.u,
               query.hit.v};
  }

  bool IsBlocked(const Vector3f& origin, const Vector3f& direction,
                 float reach) const {
    RTCRay ray = MakeRay(origin, direction, reach);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_, &context, &ray);
    return ray.tfar < 0;
  }

 private:
  static RTCRay MakeRay(const Vector3f& origin, const Vector3f& direction,
                        float reach) {
    RTCRay ray{};
    ray.org_x = origin.x();
    ray.org_y = origin.y();
    ray.org_z = origin.z();
    ray.dir_x = direction.x();
    ray.dir_y = direction.y();
    ray.dir_z = direction.z();
    ray.tfar = reach;
    ray.mask = ~0U;
    return ray;
  }

  RTCDevice device_;
  RTCScene scene_;
};

// Pinhole camera: right, up, back are the columns of R_OC.
struct Camera {
  Eigen::Matrix3d R_OC;
  Vector3d p_OC;
  double tan_x;  // Half the picture's width at distance 1.
  double tan_y;
};

Eigen::Matrix3d CalcCameraRotation(const View& view) {
  const Vector3d back = CalcCameraDirection(view);
  const Vector3d right = view.up_O.cross(back).normalized();
  Eigen::Matrix3d R_OC;
  R_OC << right, back.cross(right), back;
  return R_OC;
}

// Stands as near as shows every corner within kFrameShare of the picture,
// centred on what is seen.
Camera MakeCamera(const std::vector<Vector3f>& corners, const View& view) {
  Camera camera;
  camera.R_OC = CalcCameraRotation(view);
  const double aspect = static_cast<double>(view.width) / view.height;
  const double tangent = std::tan(kHalfViewAngle);
  camera.tan_x = aspect >= 1 ? tangent * aspect : tangent;
  camera.tan_y = aspect >= 1 ? tangent : tangent / aspect;
  // A corner at (x, y, z) relative to the point looked at lies inside when
  // |x| <= share · tan_x · (distance - z), and the same for y: four planes per
  // corner, so the nearest camera is where the two tightest pairs meet.
  const double a = kFrameShare * camera.tan_x;
  const double b = kFrameShare * camera.tan_y;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double left = -kInfinity, right = -kInfinity;
  double below = -kInfinity, above = -kInfinity;
  for (const Vector3f& corner : corners) {
    const Vector3d p = camera.R_OC.transpose() * corner.cast<double>();
    right = std::max(right, p.x() + a * p.z());
    left = std::max(left, -p.x() + a * p.z());
    above = std::max(above, p.y() + b * p.z());
    below = std::max(below, -p.y() + b * p.z());
  }
  const double z =
      std::max((right + left) / (2 * a), (above + below) / (2 * b));
  camera.p_OC =
      camera.R_OC * Vector3d((right - left) / 2, (above - below) / 2, z);
  return camera;
}

// The i-th of n points of a fixed low-discrepancy set (Hammersley) in [0, 1)².
Eigen::Vector2f CalcSamplePoint(int i, int n) {
  float inverse = 0;
  float digit = 0.5F;
  for (int bits = i; bits > 0; bits >>= 1, digit /= 2) {
    if (bits & 1) inverse += digit;
  }
  return {(static_cast<float>(i) + 0.5F) / static_cast<float>(n), inverse};
}

// A right-handed basis whose z is n (Duff et al. 2017).
Eigen::Matrix3f MakeBasis(const Vector3f& n) {
  const float sign = std::copysign(1.0F, n.z());
  const float a = -1.0F / (sign + n.z());
  const float b = n.x() * n.y() * a;
  Eigen::Matrix3f basis;
  basis << Vector3f(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
      Vector3f(b, sign + n.y() * n.y() * a, -n.y()), n;
  return basis;
}

class Shader {
 public:
  Shader(const Triangles& triangles, const RayCaster& rays,
         const Camera& camera, int rays_per_pixel)
      : triangles_(triangles), rays_(rays), rays_per_pixel_(rays_per_pixel) {
    const Eigen::Matrix3f R_OC = camera.R_OC.cast<float>();
    key_ = MakeBasis(R_OC * Vector3f(-0.60F, 0.65F, 0.55F).normalized());
    fill_ = R_OC * Vector3f(0.80F, 0.10F, 0.60F).normalized();
    Vector3f low = triangles.corners[0];
    Vector3f high = low;
    for (const Vector3f& corner : triangles.corners) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
    diagonal_ = (high - low).norm();
  }

  // Light that leaves the hit towards the eye, linear. Samples of shadow and
  // occlusion are spread over the rays of a pixel: this is ray number `ray`.
  Vector3f CalcLight(const Hit& hit, const Vector3f& eye,
                     const Vector3f& direction, int ray) const {
    const size_t first = 3 * static_cast<size_t>(hit.triangle);
    const Vector3f* p = &triangles_.corners[first];
    const Vector3f* n = &triangles_.normals[first];
    Vector3f flat = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    if (flat.dot(direction) > 0) flat = -flat;
    Vector3f smooth =
        ((1 - hit.u - hit.v) * n[0] + hit.u * n[1] + hit.v * n[2]).normalized();
    if (smooth.dot(flat) < 0) smooth = -smooth;
    const Vector3f origin =
        eye + hit.distance * direction + 2e-4F * diagonal_ * flat;

    float light = kFillLight * std::max(0.0F, smooth.dot(fill_));
    light += CalcKeyLight(origin, smooth, ray);
    light += CalcAmbientLight(origin, smooth, ray);
    return light * triangles_.colours[hit.triangle];
  }

 private:
  float CalcKeyLight(const Vector3f& origin, const Vector3f& normal,
                     int ray) const {
    const Eigen::Vector2f s = CalcSamplePoint(ray, rays_per_pixel_);
    const float radius = kKeyRadius * std::sqrt(s.x());
    const float turn = 2 * std::numbers::pi_v<float> * s.y();
    const Vector3f direction =
        (key_ * Vector3f(radius * std::cos(turn), radius * std::sin(turn), 1))
            .normalized();
    const float cosine = normal.dot(direction);
    if (cosine <= 0 || rays_.IsBlocked(origin, direction, 2 * diagonal_)) {
      return 0;
    }
    return kKeyLight * cosine;
  }

  float CalcAmbientLight(const Vector3f& origin, const Vector3f& normal,
                         int ray) const {
    const Eigen::Matrix3f basis = MakeBasis(normal);
    int free = 0;
    for (int k = 0; k < kAmbientRaysPerRay; ++k) {
      const Eigen::Vector2f s = CalcSamplePoint(
          k * rays_per_pixel_ + ray, kAmbientRaysPerRay * rays_per_pixel_);
      // Cosine-weighted over the hemisphere.
      const float radius = std::sqrt(s.x());
      const float turn = 2 * std::numbers::pi_v<float> * s.y();
      const Vector3f direction =
          basis * Vector3f(radius * std::cos(turn), radius * std::sin(turn),
                           std::sqrt(1 - s.x()));
      const float reach = static_cast<float>(kAmbientReach) * diagonal_;
      if (!rays_.IsBlocked(origin, direction, reach)) ++free;
    }
    return kAmbientLight * static_cast<float>(free) / kAmbientRaysPerRay;
  }

  const Triangles& triangles_;
  const RayCaster& rays_;
  int rays_per_pixel_;
  Eigen::Matrix3f key_;
  Vector3f fill_;
  float diagonal_;
};

// Linear light of the background in the given row.
Vector3f CalcBackground(int row, int height) {
  const float t = (static_cast<float>(row) + 0.5F) / static_cast<float>(height);
  return ((1 - t) * kBackgroundTop + t * kBackgroundBottom)
      .unaryExpr(&ToLinear);
}

void WritePixel(const Vector3f& linear, uint8_t* pixel) {
  for (int c = 0; c < 3; ++c) {
    const float value = std::clamp(ToSrgb(linear[c]), 0.0F, 1.0F);
    pixel[c] = static_cast<uint8_t>(std::lround(255 * value));
  }
}

}  // namespace

Vector3d CalcCameraDirection(const View& view) {
  const Vector3d direction(std::cos(view.elevation) * std::cos(view.azimuth),
                           std::cos(view.elevation) * std::sin(view.azimuth),
                           std::sin(view.elevation));
  return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), view.up_O) *
         direction;
}

Image RenderScene(const std::vector<RenderItem>& items, const View& view) {
  GRASPDB_EXPECTS(view.width >= 1 && view.width <= 16384);
  GRASPDB_EXPECTS(view.height >= 1 && view.height <= 16384);
  GRASPDB_EXPECTS(view.antialiasing >= 1 && view.antialiasing <= 8);
  GRASPDB_EXPECTS(std::abs(view.elevation) <= 1.5);
  Image image{view.width, view.height, {}};
  image.rgb.resize(3 * static_cast<size_t>(view.width) * view.height);

  const Triangles triangles = CollectTriangles(items);
  if (triangles.colours.empty()) {
    for (int y = 0; y < view.height; ++y) {
      const Vector3f light = CalcBackground(y, view.height);
      for (int x = 0; x < view.width; ++x) {
        WritePixel(light,
                   &image.rgb[3 * (static_cast<size_t>(y) * view.width + x)]);
      }
    }
    return image;
  }

  const RayCaster rays(triangles.corners);
  const Camera camera = MakeCamera(triangles.corners, view);
  const int n = view.antialiasing;
  const Shader shader(triangles, rays, camera, n * n);
  const Vector3f eye = camera.p_OC.cast<float>();

  const auto render_row = [&](int y) {
    const Vector3f background = CalcBackground(y, view.height);
    for (int x = 0; x < view.width; ++x) {
      Vector3f sum = Vector3f::Zero();
      for (int ray = 0; ray < n * n; ++ray) {
        const double sx = (x + (ray % n + 0.5) / n) / view.width;
        const double sy = (y + (ray / n + 0.5) / n) / view.height;
        const Vector3d direction_C((2 * sx - 1) * camera.tan_x,
                                   (1 - 2 * sy) * camera.tan_y, -1);
        const Vector3f direction =
            (camera.R_OC * direction_C.normalized()).cast<float>();
        const std::optional<Hit> hit = rays.FindFirst(eye, direction);
        sum += hit ? shader.CalcLight(*hit, eye, direction, ray) : background;
      }
      WritePixel(sum / static_cast<float>(n * n),
                 &image.rgb[3 * (static_cast<size_t>(y) * view.width + x)]);
    }
  };
  RunInArena(view.threads, [&] { ParallelFor(view.height, render_row); });
  return image;
}

}  // namespace graspdb
