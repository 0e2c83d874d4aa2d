#include "engine/render/pixel_font.h"

#include <string>

#include <gtest/gtest.h>

namespace graspdb {
namespace {

Image White(int width, int height) {
  return {width, height, std::vector<uint8_t>(3UL * width * height, 255)};
}

// The image as rows of '#' (drawn) and '.' (white).
std::string Picture(const Image& image) {
  std::string picture;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      picture += image.rgb[3 * (y * image.width + x)] == 255 ? '.' : '#';
    }
    picture += '\n';
  }
  return picture;
}

TEST(PixelFont, DrawsTheDigitsOfANumber) {
  Image image = White(8, 5);
  DrawText("14", 0, 0, 1, Rgb{}, image);
  EXPECT_EQ(Picture(image),
            ".#..#.#.\n"
            "##..#.#.\n"
            ".#..###.\n"
            ".#....#.\n"
            "###...#.\n");
}

TEST(PixelFont, SmallLettersLookLikeCapitals) {
  Image small = White(40, 5);
  Image capital = White(40, 5);
  DrawText("handle", 0, 0, 1, Rgb{}, small);
  DrawText("HANDLE", 0, 0, 1, Rgb{}, capital);
  EXPECT_EQ(small, capital);
}

TEST(PixelFont, ScaleEnlargesEachPixel) {
  Image image = White(6, 10);
  DrawText("l", 0, 0, 2, Rgb{}, image);
  EXPECT_EQ(Picture(image),
            "##....\n##....\n##....\n##....\n##....\n"
            "##....\n##....\n##....\n######\n######\n");
}

TEST(PixelFont, UnknownCharactersLeaveAGap) {
  Image image = White(12, 5);
  Image gap = White(12, 5);
  DrawText("1?1", 0, 0, 1, Rgb{}, image);
  DrawText("1 1", 0, 0, 1, Rgb{}, gap);
  EXPECT_EQ(image, gap);
}

TEST(PixelFont, WhatLiesOutsideIsCut) {
  Image image = White(4, 4);
  DrawText("8888", -2, -2, 3, Rgb{}, image);
  EXPECT_EQ(image.rgb.size(), 48U);
}

}  // namespace
}  // namespace graspdb
