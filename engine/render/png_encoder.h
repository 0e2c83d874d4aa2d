#pragma once

#include <cstdint>
#include <vector>

#include "engine/render/scene_renderer.h"

namespace graspdb {

/** The image as a PNG file. The same image gives the same bytes.
 @pre width, height >= 1 and rgb holds 3 · width · height bytes. */
std::vector<uint8_t> EncodePng(const Image& image);

}  // namespace graspdb
