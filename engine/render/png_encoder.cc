#include "engine/render/png_encoder.h"

#include <stdexcept>
#include <string>

#include <png.h>

#include "engine/base/contract.h"

namespace graspdb {

std::vector<uint8_t> EncodePng(const Image& image) {
  GRASPDB_EXPECTS(image.width >= 1 && image.height >= 1);
  GRASPDB_EXPECTS(image.rgb.size() ==
                  3 * static_cast<size_t>(image.width) * image.height);
  png_image description{};
  description.version = PNG_IMAGE_VERSION;
  description.width = static_cast<png_uint_32>(image.width);
  description.height = static_cast<png_uint_32>(image.height);
  description.format = PNG_FORMAT_RGB;

  std::vector<uint8_t> bytes(PNG_IMAGE_PNG_SIZE_MAX(description));
  png_alloc_size_t size = bytes.size();
  if (!png_image_write_to_memory(&description, bytes.data(), &size, 0,
                                 image.rgb.data(), 0, nullptr)) {
    throw std::runtime_error(std::string("libpng: ") + description.message);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace graspdb
