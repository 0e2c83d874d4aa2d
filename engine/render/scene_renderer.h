#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/triangle_mesh.h"

namespace graspdb {

/** A colour in sRGB, each channel 0..1. */
struct Rgb {
  float r{0};
  float g{0};
  float b{0};

  bool operator==(const Rgb&) const = default;
};

/** A coloured mesh in the scene's frame O. */
struct RenderItem {
  TriangleMesh mesh_O;
  std::vector<Rgb> colours;  ///< One for all, or one per face.
};

/** Rows from top to bottom, three bytes (sRGB) per pixel. */
struct Image {
  int width{0};
  int height{0};
  std::vector<uint8_t> rgb;

  bool operator==(const Image&) const = default;
};

/** Where the camera stands and how fine the picture is. The camera always looks
 at the middle of the scene, from as near as shows all of it. */
struct View {
  int width{800};
  int height{600};
  /** About up_O, from the scene's +x towards its +y for the default up_O, rad:
   the default looks from the front right. */
  double azimuth{-1.05};
  double elevation{0.45};  ///< Above the horizon, rad, within ±1.5.
  Eigen::Vector3d up_O{Eigen::Vector3d::UnitZ()};
  int antialiasing{3};  ///< Rays per pixel, along x and along y.
  int threads{0};       ///< 0: as many as there are cores.
};

/** The unit vector from the scene's middle to the camera. */
Eigen::Vector3d CalcCameraDirection(const View& view);

/** Draws opaque items by ray casting: soft key and fill light that move with
 the camera, soft shadows, ambient occlusion, smooth shading where faces meet
 at small angles, a light background. A scene without faces is all background.
 The same bytes for any number of threads.
 @pre 1 <= width, height <= 16384; 1 <= antialiasing <= 8; every mesh has one
   colour or as many as faces; every vertex is finite. */
Image RenderScene(const std::vector<RenderItem>& items, const View& view);

}  // namespace graspdb
