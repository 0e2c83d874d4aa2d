#include "engine/render/png_encoder.h"

#include <gtest/gtest.h>
#include <png.h>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

// Every channel takes its own course, so that a swap would show.
Image MakePattern(int width, int height) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.rgb.push_back(static_cast<uint8_t>(x));
      image.rgb.push_back(static_cast<uint8_t>(7 * y));
      image.rgb.push_back(static_cast<uint8_t>(x * y));
    }
  }
  return image;
}

Image Decode(const std::vector<uint8_t>& bytes) {
  png_image description{};
  description.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&description, bytes.data(),
                                               bytes.size()));
  description.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(description.width),
              static_cast<int>(description.height),
              {}};
  image.rgb.resize(PNG_IMAGE_SIZE(description));
  EXPECT_TRUE(png_image_finish_read(&description, nullptr, image.rgb.data(), 0,
                                    nullptr));
  return image;
}

TEST(PngEncoder, StartsWithThePngSignature) {
  const std::vector<uint8_t> bytes = EncodePng(MakePattern(2, 2));
  const std::vector<uint8_t> signature{0x89, 'P', 'N', 'G', 13, 10, 26, 10};
  ASSERT_GT(bytes.size(), 8U);
  EXPECT_EQ(std::vector<uint8_t>(bytes.begin(), bytes.begin() + 8), signature);
}

TEST(PngEncoder, DecodesToTheSamePixels) {
  for (const Image& image :
       {MakePattern(1, 1), MakePattern(37, 5), MakePattern(64, 129)}) {
    EXPECT_EQ(Decode(EncodePng(image)), image);
  }
}

TEST(PngEncoder, SameImageGivesTheSameBytes) {
  EXPECT_EQ(EncodePng(MakePattern(50, 40)), EncodePng(MakePattern(50, 40)));
}

TEST(PngEncoder, RefusesAnImageWithMissingBytes) {
  Image image = MakePattern(4, 4);
  image.rgb.pop_back();
  EXPECT_THROW(EncodePng(image), ContractViolation);
  EXPECT_THROW(EncodePng(Image{}), ContractViolation);
}

}  // namespace
}  // namespace graspdb
