#pragma once

#include <array>

#include <Eigen/Core>

#include "engine/geometry/triangle_mesh.h"
#include "engine/render/scene_renderer.h"

namespace graspdb {

/** A box with the given half lengths; faces in the order -x +x -y +y -z +z, two
 triangles each. */
inline TriangleMesh MakeBox(const Eigen::Vector3d& centre,
                            const Eigen::Vector3d& half) {
  std::vector<Eigen::Vector3d> vertices;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d sign(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    vertices.push_back(centre + sign.cwiseProduct(half));
  }
  return TriangleMesh(std::move(vertices), {{0, 4, 6},
                                            {0, 6, 2},
                                            {1, 3, 7},
                                            {1, 7, 5},
                                            {0, 1, 5},
                                            {0, 5, 4},
                                            {2, 6, 7},
                                            {2, 7, 3},
                                            {0, 2, 3},
                                            {0, 3, 1},
                                            {4, 5, 7},
                                            {4, 7, 6}});
}

/** The pixel in column x, row y. */
inline std::array<int, 3> PixelAt(const Image& image, int x, int y) {
  const size_t at = 3 * (static_cast<size_t>(y) * image.width + x);
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

}  // namespace graspdb
