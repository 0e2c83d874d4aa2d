#include "engine/admission/graspable_size.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/workshop.h"

namespace graspdb {
namespace {

using ::testing::HasSubstr;

Result<void> CheckBox(double largest_side, double metres_per_unit) {
  return CheckGraspableSize(
      workshop::MakeBox({largest_side, 0.1 * largest_side, 0.1 * largest_side}),
      metres_per_unit);
}

TEST(CheckGraspableSize, AcceptsFiveMillimetresToTwoMetres) {
  for (const double side : {0.0051, 0.1, 1.99}) {
    EXPECT_TRUE(CheckBox(side, 1.0).has_value()) << side;
  }
  for (const double side : {0.0049, 2.01, 120.0}) {
    const auto result = CheckBox(side, 1.0);
    ASSERT_FALSE(result.has_value()) << side;
    EXPECT_EQ(result.error().code, ErrorCode::kUnusableInput);
    EXPECT_EQ(result.error().field, "units");
  }
}

TEST(CheckGraspableSize, NamesTheLikelyUnit) {
  // A mug of 120 mm, taken for metres, centimetres and inches.
  for (const double scale : {1.0, 0.01 * 100, 0.0254}) {
    EXPECT_THAT(CheckBox(120 * scale, scale).error().hint,
                HasSubstr("units=mm"));
  }
  // 12 cm taken for metres; 0.12 m taken for millimetres.
  EXPECT_THAT(CheckBox(12.0, 1.0).error().hint, HasSubstr("units=cm"));
  EXPECT_THAT(CheckBox(0.12e-3, 0.001).error().hint, HasSubstr("units=m."));
  EXPECT_THAT(CheckBox(5e6, 1.0).error().hint, HasSubstr("Scale the mesh"));
}

}  // namespace
}  // namespace graspdb
