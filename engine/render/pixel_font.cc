#include "engine/render/pixel_font.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

struct Glyph {
  char character;
  int rows;
};

// Five octal digits, one per row from the top; in a digit 4 is the left pixel,
// 2 the middle one and 1 the right one.
constexpr Glyph kGlyphs[] = {
    {'0', 075557}, {'1', 026227}, {'2', 071747}, {'3', 071717}, {'4', 055711},
    {'5', 074717}, {'6', 074757}, {'7', 071244}, {'8', 075757}, {'9', 075717},
    {'A', 025755}, {'B', 065656}, {'C', 034443}, {'D', 065556}, {'E', 074647},
    {'F', 074644}, {'G', 034553}, {'H', 055755}, {'I', 072227}, {'J', 011152},
    {'K', 055655}, {'L', 044447}, {'M', 057755}, {'N', 065555}, {'O', 025552},
    {'P', 065644}, {'Q', 025563}, {'R', 065655}, {'S', 034216}, {'T', 072222},
    {'U', 055557}, {'V', 055552}, {'W', 055775}, {'X', 055255}, {'Y', 055222},
    {'Z', 071247}, {'.', 000002}, {',', 000024}, {':', 002020}, {';', 002024},
    {'-', 000700}, {'+', 002720}, {'/', 011244}, {'%', 051245}, {'=', 007070},
    {'#', 057575}, {'(', 012221}, {')', 042224}, {'_', 000007}};

int FindGlyph(char character) {
  const int capital = std::toupper(static_cast<unsigned char>(character));
  for (const Glyph& glyph : kGlyphs) {
    if (glyph.character == capital) return glyph.rows;
  }
  return 0;
}

void FillSquare(int x, int y, int size, const Rgb& colour, Image& image) {
  const float channels[3] = {colour.r, colour.g, colour.b};
  for (int row = std::max(0, y); row < std::min(image.height, y + size);
       ++row) {
    for (int column = std::max(0, x); column < std::min(image.width, x + size);
         ++column) {
      const size_t pixel = static_cast<size_t>(row) * image.width + column;
      for (int c = 0; c < 3; ++c) {
        image.rgb[3 * pixel + c] =
            static_cast<uint8_t>(std::lround(255 * channels[c]));
      }
    }
  }
}

}  // namespace

void DrawText(const std::string& text, int x, int y, int scale,
              const Rgb& colour, Image& image) {
  GRASPDB_EXPECTS(scale >= 1);
  for (char character : text) {
    const int glyph = FindGlyph(character);
    for (int bit = 0; bit < 3 * kGlyphHeight; ++bit) {
      if (glyph >> (3 * kGlyphHeight - 1 - bit) & 1) {
        FillSquare(x + scale * (bit % 3), y + scale * (bit / 3), scale, colour,
                   image);
      }
    }
    x += scale * kGlyphWidth;
  }
}

}  // namespace graspdb
