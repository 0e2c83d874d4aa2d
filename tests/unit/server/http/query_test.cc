#include "server/http/query.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace graspdb {
namespace {

using testing::HasSubstr;

Error FinishError(const QueryReader& query) {
  const auto result = query.Finish();
  return result ? Error{} : result.error();
}

TEST(QueryReader, ReadsEachType) {
  const TextPairs pairs{
      {"a", "x y"}, {"b", "-3"}, {"c", "2.5e-1"}, {"d", "true"}, {"e", "mm"}};
  QueryReader query(pairs);
  EXPECT_EQ(query.Text("a"), "x y");
  EXPECT_EQ(query.Integer("b", -3, 3), -3);
  EXPECT_EQ(query.Number("c", 0, 1), 0.25);
  EXPECT_EQ(query.Boolean("d"), true);
  EXPECT_EQ(query.Choice("e", {"m", "mm"}), "mm");
  EXPECT_TRUE(query.Finish());
}

TEST(QueryReader, AnAbsentParameterIsNothingAndNoError) {
  const TextPairs pairs;
  QueryReader query(pairs);
  EXPECT_EQ(query.Integer("count", 1, 10), std::nullopt);
  EXPECT_EQ(query.Text("part"), std::nullopt);
  EXPECT_TRUE(query.Finish());
}

TEST(QueryReader, AnUnknownParameterIsNamedWithTheKnownOnes) {
  const TextPairs pairs{{"colour", "red"}};
  QueryReader query(pairs);
  query.Text("part");
  query.Text("hand");
  const Error error = FinishError(query);
  EXPECT_EQ(error.code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(error.field, "colour");
  EXPECT_EQ(error.hint, "It takes hand, part.");
}

TEST(QueryReader, ARepeatedParameterIsRefusedEvenWithEqualValues) {
  const TextPairs pairs{{"seed", "1"}, {"seed", "1"}};
  QueryReader query(pairs);
  EXPECT_EQ(query.Integer("seed", 0), std::nullopt);
  EXPECT_EQ(FinishError(query).field, "seed");
}

TEST(QueryReader, AnIntegerMustBeOneAndInRange) {
  for (const char* text : {"0", "1001", "1.0", "", " 1", "+1", "1x", "0x10",
                           "99999999999999999999"}) {
    const TextPairs pairs{{"count", text}};
    QueryReader query(pairs);
    EXPECT_EQ(query.Integer("count", 1, 1000), std::nullopt) << text;
    const Error error = FinishError(query);
    EXPECT_EQ(error.field, "count") << text;
    EXPECT_THAT(error.message,
                HasSubstr("count takes an integer from 1 to 1000, not"));
  }
}

TEST(QueryReader, ANumberMustBeFiniteAndInRange) {
  for (const char* text : {"-1", "0", "2.1", "nan", "inf", "1e400", "0,5"}) {
    const TextPairs pairs{{"friction", text}};
    QueryReader query(pairs);
    EXPECT_EQ(query.Number("friction", 0, 2, /*above=*/true), std::nullopt);
    EXPECT_THAT(FinishError(query).message,
                HasSubstr("friction takes a number above 0 up to 2, not"))
        << text;
  }
}

TEST(QueryReader, AChoiceListsItsWords) {
  const TextPairs pairs{{"units", "furlong"}};
  QueryReader query(pairs);
  EXPECT_EQ(query.Choice("units", {"m", "mm"}), std::nullopt);
  EXPECT_EQ(FinishError(query).message, "units takes m, mm, not \"furlong\".");
}

TEST(QueryReader, ATextIsNeitherEmptyNorEndless) {
  for (const std::string& text : {std::string(), std::string(257, 'x')}) {
    const TextPairs pairs{{"part", text}};
    QueryReader query(pairs);
    EXPECT_EQ(query.Text("part"), std::nullopt);
    EXPECT_LT(FinishError(query).message.size(), 200);
  }
}

TEST(QueryReader, TheFirstErrorIsKept) {
  const TextPairs pairs{{"count", "0"}, {"seed", "x"}, {"unknown", ""}};
  QueryReader query(pairs);
  query.Integer("count", 1, 10);
  query.Integer("seed", 0);
  EXPECT_EQ(FinishError(query).field, "count");
}

}  // namespace
}  // namespace graspdb
