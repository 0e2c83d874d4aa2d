#include "engine/render/grasp_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/contract.h"
#include "engine/render/pixel_font.h"

namespace graspdb {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

constexpr std::array<Rgb, 7> kPartColours{{
    {0.34F, 0.71F, 0.91F},  // sky blue
    {0.90F, 0.62F, 0.00F},  // orange
    {0.00F, 0.62F, 0.45F},  // bluish green
    {0.80F, 0.47F, 0.65F},  // reddish purple
    {0.94F, 0.89F, 0.26F},  // yellow
    {0.00F, 0.45F, 0.70F},  // blue
    {0.84F, 0.37F, 0.00F},  // vermilion
}};
constexpr Rgb kFingerColour{0.80F, 0.79F, 0.77F};
constexpr Rgb kPalmColour{0.50F, 0.49F, 0.48F};
constexpr Rgb kContactColour{0.10F, 0.05F, 0.10F};
constexpr Rgb kCaptionColour{0.15F, 0.15F, 0.20F};
constexpr double kContactRadius = 0.0028;  // m
// Cosines gained that justify another turn of the camera.
constexpr double kWorthATurn = 0.05;

// A sphere of 12 meridians and 8 bands.
TriangleMesh MakeSphere(const Vector3d& centre, double radius) {
  constexpr int kMeridians = 12;
  constexpr int kBands = 8;
  std::vector<Vector3d> vertices{centre + radius * Vector3d::UnitZ()};
  for (int band = 1; band < kBands; ++band) {
    const double polar = kPi * band / kBands;
    for (int m = 0; m < kMeridians; ++m) {
      const double turn = 2 * kPi * m / kMeridians;
      vertices.push_back(centre +
                         radius * Vector3d(std::sin(polar) * std::cos(turn),
                                           std::sin(polar) * std::sin(turn),
                                           std::cos(polar)));
    }
  }
  vertices.push_back(centre - radius * Vector3d::UnitZ());
  const int south = static_cast<int>(vertices.size()) - 1;

  std::vector<Eigen::Vector3i> triangles;
  for (int m = 0; m < kMeridians; ++m) {
    const int next = (m + 1) % kMeridians;
    triangles.emplace_back(0, 1 + m, 1 + next);
    for (int band = 0; band + 2 < kBands; ++band) {
      const int upper = 1 + band * kMeridians;
      const int lower = upper + kMeridians;
      triangles.emplace_back(upper + m, lower + m, lower + next);
      triangles.emplace_back(upper + m, lower + next, upper + next);
    }
    const int last = 1 + (kBands - 2) * kMeridians;
    triangles.emplace_back(last + m, south, last + next);
  }
  return TriangleMesh(std::move(vertices), std::move(triangles));
}

void AddHand(const PosedHand& posed, std::vector<RenderItem>& items) {
  GRASPDB_EXPECTS(posed.hand != nullptr);
  const HandConfiguration& configuration = posed.configuration;
  const std::vector<RigidTransform> X_HL =
      CalcLinkPoses(*posed.hand, configuration.q);
  for (int link = 0; link < posed.hand->num_links(); ++link) {
    const Rgb colour = link == 0 ? kPalmColour : kFingerColour;
    for (const TriangleMesh& piece_L : posed.hand->links()[link].pieces_L) {
      items.push_back(
          {CalcTransformed(piece_L, configuration.X_OH * X_HL[link]),
           {colour}});
    }
  }
  for (const Vector3d& p_O : posed.contacts_O) {
    items.push_back({MakeSphere(p_O, kContactRadius), {kContactColour}});
  }
}

// Copies a cell's picture to the sheet with its top left corner at (x, y).
void Paste(const Image& cell, int x, int y, Image& sheet) {
  for (int row = 0; row < cell.height; ++row) {
    const auto from = cell.rgb.begin() + 3L * row * cell.width;
    std::copy(from, from + 3L * cell.width,
              sheet.rgb.begin() + 3L * (1L * (y + row) * sheet.width + x));
  }
}

}  // namespace

Rgb PartColour(int label) {
  GRASPDB_EXPECTS(label >= 0);
  return kPartColours[label % kPartColours.size()];
}

std::vector<RenderItem> MakeGraspScene(const TriangleMesh& mesh_O,
                                       const std::vector<int>& face_labels,
                                       const std::vector<PosedHand>& hands) {
  RenderItem object{mesh_O, {}};
  for (int label : face_labels) object.colours.push_back(PartColour(label));
  if (face_labels.empty()) object.colours = {PartColour(0)};
  std::vector<RenderItem> items{std::move(object)};
  for (const PosedHand& hand : hands) AddHand(hand, items);
  return items;
}

View TurnTowards(const TriangleMesh& mesh_O, const PosedHand& hand,
                 const View& view) {
  // Where the contacts lie, from the middle of the object, in half diagonals.
  Vector3d offset_O = Vector3d::Zero();
  const Vector3d p_OM = (mesh_O.box_min() + mesh_O.box_max()) / 2;
  for (const Vector3d& p_OC : hand.contacts_O) {
    offset_O += (p_OC - p_OM) / static_cast<double>(hand.contacts_O.size());
  }
  offset_O /= std::max(mesh_O.diagonal() / 2, 1e-9);

  View best = view;
  double least = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < 8; ++turn) {
    View candidate = view;
    candidate.azimuth += turn * kPi / 4;
    const Vector3d direction_O = CalcCameraDirection(candidate);
    const double cost = std::abs(direction_O.dot(hand.approach_O)) +
                        std::abs(direction_O.dot(offset_O));
    if (cost < least - kWorthATurn) {
      least = cost;
      best = candidate;
    }
  }
  return best;
}

Image RenderContactSheet(const std::vector<SheetCell>& cells, int columns,
                         const View& cell) {
  GRASPDB_EXPECTS(columns >= 1);
  const int count = static_cast<int>(cells.size());
  const int rows = std::max(1, (count + columns - 1) / columns);
  Image sheet{columns * cell.width, rows * cell.height, {}};
  sheet.rgb.assign(3L * sheet.width * sheet.height, 255);
  const int scale = std::max(1, cell.height / 110);
  for (int i = 0; i < count; ++i) {
    Image picture = RenderScene(
        MakeGraspScene(*cells[i].mesh_O, cells[i].face_labels, {cells[i].hand}),
        TurnTowards(*cells[i].mesh_O, cells[i].hand, cell));
    DrawText(cells[i].caption, 3 * scale,
             cell.height - (kGlyphHeight + 3) * scale, scale, kCaptionColour,
             picture);
    Paste(picture, i % columns * cell.width, i / columns * cell.height, sheet);
  }
  return sheet;
}

}  // namespace graspdb
