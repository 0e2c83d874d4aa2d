#include "engine/geometry/solid.h"

#include <utility>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// Cells of 1-1.5 mm for objects that a hand can hold, 2 MB. The field proves
// what is farther away than its error; half the cells cost twice the exact
// tests.
constexpr int kFieldCells = 96;
constexpr double kFieldMargin = 0.01;

}  // namespace

Solid::Solid(TriangleMesh mesh_O, int num_surface_faces,
             std::shared_ptr<const SeenSurface> seen)
    : mesh_O_(std::move(mesh_O)),
      num_surface_faces_(num_surface_faces < 0 ? mesh_O_.num_triangles()
                                               : num_surface_faces),
      seen_(std::move(seen)),
      mass_(CalcMassProperties(mesh_O_)),
      index_(mesh_O_),
      field_(mesh_O_, index_, kFieldCells, kFieldMargin),
      shape_(mesh_O_) {
  GRASPDB_EXPECTS(num_surface_faces_ <= mesh_O_.num_triangles());
}

int64_t Solid::CalcBytes() const {
  // Triangles, and what the index and FCL keep of each.
  constexpr int64_t kBytesPerTriangle = 600;
  return field_.bytes() + kBytesPerTriangle * mesh_O_.num_triangles();
}

}  // namespace graspdb
