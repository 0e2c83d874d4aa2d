#pragma once

#include <string>

#include "engine/render/scene_renderer.h"

namespace graspdb {

/** A character's width and height, with the gap after it, in unscaled pixels.
 */
constexpr int kGlyphWidth = 4;
constexpr int kGlyphHeight = 5;

/** Draws text in capitals with its top left corner at (x, y), each pixel of the
 3 x 5 font `scale` wide. Knows digits, letters and " .,:;-+/%=#()_"; other
 characters leave a gap. What lies outside the image is cut. @pre scale >= 1. */
void DrawText(const std::string& text, int x, int y, int scale,
              const Rgb& colour, Image& image);

}  // namespace graspdb
