#include "engine/base/result.h"

#include <gtest/gtest.h>

namespace graspdb {
namespace {

Result<int> Half(int n) {
  if (n % 2 != 0) return Error{ErrorCode::kInvalidArgument, "odd"};
  return n / 2;
}

Result<int> Quarter(int n) {
  GRASPDB_TRY(half, Half(n));
  return Half(half);
}

TEST(Result, TryPassesTheErrorOn) {
  EXPECT_EQ(*Quarter(8), 2);
  EXPECT_EQ(Quarter(6).error().message, "odd");
}

TEST(Result, TheValueOfAnErrorIsAContractViolation) {
  EXPECT_THROW((void)Half(1).value(), ContractViolation);
  EXPECT_THROW((void)Half(2).error(), ContractViolation);
}

}  // namespace
}  // namespace graspdb
