#include "engine/admission/graspable_size.h"

#include <fmt/core.h>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

constexpr double kSmallest = 0.005;
constexpr double kLargest = 2.0;
// The largest side of most things that one hand holds.
constexpr double kUsualSmallest = 0.03;
constexpr double kUsualLargest = 0.6;

struct Unit {
  const char* symbol;
  const char* name;
  double metres;
};
// The likelier first: 12 may be centimetres or inches, 120 only millimetres.
constexpr Unit kUnits[] = {{"mm", "millimetres", 0.001},
                           {"cm", "centimetres", 0.01},
                           {"m", "metres", 1.0},
                           {"in", "inches", 0.0254}};

std::string MakeUnitHint(double side_in_units) {
  for (const auto& [low, high] : {std::pair(kUsualSmallest, kUsualLargest),
                                  std::pair(kSmallest, kLargest)}) {
    for (const Unit& unit : kUnits) {
      const double side = side_in_units * unit.metres;
      if (side < low || side > high) continue;
      return fmt::format(
          "In {} its largest side would be {:.3g} m: try units={}.", unit.name,
          side, unit.symbol);
    }
  }
  return "Scale the mesh, or state its unit with units=m, mm, cm or in.";
}

}  // namespace

Result<void> CheckGraspableSize(const TriangleMesh& mesh,
                                double metres_per_unit) {
  GRASPDB_EXPECTS(metres_per_unit > 0.0);
  const double side = (mesh.box_max() - mesh.box_min()).maxCoeff();
  if (side >= kSmallest && side <= kLargest) return {};
  return Error{
      ErrorCode::kUnusableInput,
      fmt::format("the largest side of the mesh is {:.3g} m, which cannot be "
                  "an object that a hand grasps (5 mm to 2 m)",
                  side),
      MakeUnitHint(side / metres_per_unit), "units"};
}

}  // namespace graspdb
