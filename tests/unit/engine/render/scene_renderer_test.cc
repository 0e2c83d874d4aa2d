#include "engine/render/scene_renderer.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/contract.h"
#include "tests/unit/engine/render/render_scenes.h"

namespace graspdb {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;
constexpr Rgb kRed{0.9F, 0.05F, 0.05F};
constexpr Rgb kBlue{0.05F, 0.05F, 0.9F};
constexpr Rgb kGrey{0.6F, 0.6F, 0.6F};

View SmallView() {
  View view;
  view.width = 80;
  view.height = 60;
  view.antialiasing = 2;
  return view;
}

// The background is the same in a whole row; anything else is an item.
bool IsItem(const Image& image, const Image& background, int x, int y) {
  return PixelAt(image, x, y) != PixelAt(background, x, y);
}

int Brightness(const std::array<int, 3>& pixel) {
  return pixel[0] + pixel[1] + pixel[2];
}

// Latitudes and longitudes of the unit sphere, poles on z.
TriangleMesh MakeUnitSphere() {
  constexpr int kBands = 24;
  constexpr int kMeridians = 48;
  std::vector<Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  for (int band = 0; band <= kBands; ++band) {
    for (int m = 0; m < kMeridians; ++m) {
      const double polar = kPi * band / kBands;
      const double turn = 2 * kPi * m / kMeridians;
      vertices.emplace_back(std::sin(polar) * std::cos(turn),
                            std::sin(polar) * std::sin(turn), std::cos(polar));
      if (band == kBands) continue;
      const int next = (m + 1) % kMeridians;
      const int low = (band + 1) * kMeridians;
      const int high = band * kMeridians;
      triangles.emplace_back(high + m, low + m, low + next);
      triangles.emplace_back(high + m, low + next, high + next);
    }
  }
  return TriangleMesh(std::move(vertices), std::move(triangles));
}

TEST(SceneRenderer, CameraDirectionFollowsAzimuthAndElevation) {
  View view;
  view.azimuth = 0;
  view.elevation = 0;
  EXPECT_TRUE(CalcCameraDirection(view).isApprox(Vector3d::UnitX()));
  view.azimuth = kPi / 2;
  EXPECT_TRUE(CalcCameraDirection(view).isApprox(Vector3d::UnitY()));
  view.elevation = kPi / 6;  // 30 degrees up: (0, cos 30, sin 30)
  EXPECT_TRUE(
      CalcCameraDirection(view).isApprox(Vector3d(0, std::sqrt(3) / 2, 0.5)));
}

TEST(SceneRenderer, CameraIsAboveAlongTheUpAxis) {
  View view;
  view.up_O = Vector3d::UnitY();
  EXPECT_NEAR(CalcCameraDirection(view).dot(Vector3d::UnitY()),
              std::sin(view.elevation), 1e-12);
}

TEST(SceneRenderer, AnEmptySceneIsAllBackground) {
  const Image image = RenderScene({}, SmallView());
  ASSERT_EQ(image.rgb.size(), 3U * 80 * 60);
  for (int x = 1; x < 80; ++x) {
    EXPECT_EQ(PixelAt(image, x, 30), PixelAt(image, 0, 30));
  }
  EXPECT_GT(Brightness(PixelAt(image, 0, 0)), 3 * 235);
}

TEST(SceneRenderer, ShowsTheWholeSceneAndFillsThePicture) {
  const View view = SmallView();
  const Image background = RenderScene({}, view);
  for (const Vector3d& half :
       {Vector3d(1, 1, 1), Vector3d(4, 0.1, 0.1), Vector3d(0.1, 0.1, 3)}) {
    const Image image =
        RenderScene({{MakeBox(Vector3d(7, -2, 3), half), {kGrey}}}, view);
    int left = view.width, right = -1, top = view.height, bottom = -1;
    for (int y = 0; y < view.height; ++y) {
      for (int x = 0; x < view.width; ++x) {
        if (!IsItem(image, background, x, y)) continue;
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
        bottom = std::max(bottom, y);
      }
    }
    // A margin of 3 % on each side: 2.4 pixels of 80, 1.8 of 60; one of the
    // two directions is filled, and what is seen is centred.
    EXPECT_GE(left, 1);
    EXPECT_GE(top, 1);
    EXPECT_LE(right, 78);
    EXPECT_LE(bottom, 58);
    EXPECT_TRUE(right - left >= 74 || bottom - top >= 55);
    // Perspective may shift the direction that is not filled a little.
    EXPECT_NEAR(left + right, 79, 6);
    EXPECT_NEAR(top + bottom, 59, 6);
  }
}

TEST(SceneRenderer, ASphereCoversADisk) {
  View view = SmallView();
  view.width = 200;
  view.height = 200;
  const Image background = RenderScene({}, view);
  const Image image = RenderScene({{MakeUnitSphere(), {kGrey}}}, view);
  int covered = 0;
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) covered += IsItem(image, background, x, y);
  }
  // The disk's diameter is 94 % of 200 pixels; every pixel on its edge counts
  // whole, half a pixel too much all round: π (94 + 0.5)².
  EXPECT_NEAR(covered, kPi * 94.5 * 94.5, 300);
}

TEST(SceneRenderer, EachFaceHasItsOwnColour) {
  // Seen from +x and +y at once: the x face lies right of the y face.
  std::vector<Rgb> colours(12, kGrey);
  colours[2] = colours[3] = kRed;   // +x
  colours[6] = colours[7] = kBlue;  // +y
  View view = SmallView();
  view.azimuth = kPi / 4;
  view.elevation = 0;
  const Image image = RenderScene(
      {{MakeBox(Vector3d::Zero(), Vector3d::Ones()), colours}}, view);
  const auto left = PixelAt(image, 30, 30);
  const auto right = PixelAt(image, 50, 30);
  EXPECT_GT(left[0], 2 * left[2]);
  EXPECT_GT(right[2], 2 * right[0]);
}

TEST(SceneRenderer, NearerItemsHideFartherOnes) {
  View view = SmallView();
  view.azimuth = 0;
  view.elevation = 0;
  const Image image = RenderScene(
      {{MakeBox(Vector3d(-1, 0, 0), Vector3d(0.1, 1, 1)), {kBlue}},
       {MakeBox(Vector3d(1, 0, 0), Vector3d(0.1, 0.5, 0.5)), {kRed}}},
      view);
  EXPECT_GT(PixelAt(image, 40, 30)[0], PixelAt(image, 40, 30)[2]);
}

TEST(SceneRenderer, AFlatFaceInTheOpenIsEvenlyLit) {
  View view = SmallView();
  view.azimuth = 0;
  view.elevation = 0;
  const Image image = RenderScene(
      {{MakeBox(Vector3d::Zero(), Vector3d(0.1, 1, 1)), {kGrey}}}, view);
  EXPECT_EQ(PixelAt(image, 30, 20), PixelAt(image, 50, 40));
}

TEST(SceneRenderer, SmoothShadingMakesNoFacetsOnASphere) {
  View view = SmallView();
  view.width = 240;
  view.height = 240;
  view.elevation = 0;
  const Image image = RenderScene({{MakeUnitSphere(), {kGrey}}}, view);
  // A facet is about 15 pixels wide and its neighbour 7.5 degrees away, which
  // flat shading would show as a step of about 15 per channel.
  for (int x = 50; x < 120; ++x) {
    EXPECT_NEAR(Brightness(PixelAt(image, x, 120)),
                Brightness(PixelAt(image, x + 1, 120)), 3 * 6);
  }
}

TEST(SceneRenderer, AFloorIsDarkerNextToAWall) {
  View view = SmallView();
  view.azimuth = 0;
  const Image image = RenderScene(
      {{MakeBox(Vector3d(0, 0, -0.05), Vector3d(1, 1, 0.05)), {kRed}},
       {MakeBox(Vector3d(-1.05, 0, 0.5), Vector3d(0.05, 1, 0.5)), {kBlue}}},
      view);
  // Down the middle column: background, wall (blue), floor (red). In the open
  // the floor would be evenly lit.
  int beside_wall = 0;
  int brightest = 0;
  for (int y = 0; y < view.height; ++y) {
    const auto pixel = PixelAt(image, 40, y);
    if (pixel[0] < 2 * pixel[2]) continue;
    if (beside_wall == 0) beside_wall = Brightness(pixel);
    brightest = std::max(brightest, Brightness(pixel));
  }
  ASSERT_GT(beside_wall, 0);
  EXPECT_LT(beside_wall, brightest - 15);
}

TEST(SceneRenderer, FacesWithoutAreaChangeNothing) {
  const TriangleMesh box = MakeBox(Vector3d::Zero(), Vector3d::Ones());
  std::vector<Eigen::Vector3i> triangles = box.triangles();
  triangles.emplace_back(0, 0, 1);
  const TriangleMesh with_needle(box.vertices(), triangles);
  EXPECT_EQ(RenderScene({{with_needle, {kRed}}}, SmallView()),
            RenderScene({{box, {kRed}}}, SmallView()));
}

TEST(SceneRenderer, ThreadsDoNotChangeABit) {
  const std::vector<RenderItem> items{
      {MakeUnitSphere(), {kRed}},
      {MakeBox(Vector3d(1, 1, 0), Vector3d(0.5, 0.3, 0.8)), {kBlue}}};
  View view = SmallView();
  view.threads = 1;
  const Image one = RenderScene(items, view);
  view.threads = 2;
  EXPECT_EQ(RenderScene(items, view), one);
  view.threads = 0;
  EXPECT_EQ(RenderScene(items, view), one);
}

TEST(SceneRenderer, RefusesTheWrongNumberOfColours) {
  const TriangleMesh box = MakeBox(Vector3d::Zero(), Vector3d::Ones());
  EXPECT_THROW(RenderScene({{box, {}}}, SmallView()), ContractViolation);
  EXPECT_THROW(RenderScene({{box, {kRed, kBlue}}}, SmallView()),
               ContractViolation);
}

}  // namespace
}  // namespace graspdb
