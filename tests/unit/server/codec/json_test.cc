#include "server/codec/json.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "engine/base/random.h"

namespace graspdb {
namespace {

using ::testing::HasSubstr;

ErrorCode CodeOf(const std::string& text) {
  const auto parsed = ParseJson(text);
  return parsed ? ErrorCode::kInternal : parsed.error().code;
}

std::string Nest(int depth) {
  const auto n = static_cast<size_t>(depth);
  return std::string(n, '[') + std::string(n, ']');
}

TEST(ParseJson, ReadsEveryKindOfValue) {
  const Json json =
      ParseJson(R"( {"a":[1,-2,0.5,true,null,"\u00e9"],"b":{}} )").value();
  EXPECT_EQ(json["a"][1].get<int>(), -2);
  EXPECT_EQ(json["a"][5].get<std::string>(), "\xC3\xA9");
  EXPECT_TRUE(json["a"][4].is_null());
  EXPECT_TRUE(json["b"].is_object());
  EXPECT_EQ(DumpJson(json), R"({"a":[1,-2,0.5,true,null,"é"],"b":{}})");
}

TEST(ParseJson, KeepsTheOrderOfKeys) {
  const std::string text = R"({"z":1,"a":2,"m":{"y":1,"x":2}})";
  EXPECT_EQ(DumpJson(ParseJson(text).value()), text);
}

TEST(ParseJson, GivesBackEveryFiniteDoubleExactly) {
  Random random(1);
  for (int i = 0; i < 20'000; ++i) {
    const double number = std::bit_cast<double>(random.NextBits());
    if (!std::isfinite(number)) continue;
    const double read = ParseJson(DumpJson(Json(number))).value().get<double>();
    ASSERT_EQ(std::bit_cast<uint64_t>(read), std::bit_cast<uint64_t>(number));
  }
}

TEST(ParseJson, AcceptsSixtyFourLevelsAndNotOneMore) {
  EXPECT_TRUE(ParseJson(Nest(64)));
  for (const int depth : {65, 100, 10'000, 500'000}) {
    EXPECT_EQ(CodeOf(Nest(depth)), ErrorCode::kInvalidArgument) << depth;
  }
  std::string objects;
  for (int i = 0; i < 65; ++i) objects += "{\"a\":";
  EXPECT_EQ(CodeOf(objects + "1" + std::string(65, '}')),
            ErrorCode::kInvalidArgument);
}

TEST(ParseJson, RefusesAMillionBracketsThatNeverClose) {
  JsonLimits limits;
  limits.max_bytes = 2'000'000;
  EXPECT_FALSE(ParseJson(std::string(1'000'000, '['), limits));
  EXPECT_FALSE(ParseJson(std::string(1'000'000, '{'), limits));
}

TEST(ParseJson, RefusesWhatIsNotJsonOrNotAFiniteNumber) {
  for (const char* text :
       {"",           " ",       "{",           "}",        "[1,]",   "{\"a\"}",
        "{'a':1}",    "NaN",     "-Infinity",   "1e400",    "-1e400", "[1e999]",
        "01",         "+1",      ".5",          "1.",       "0x10",   "tru",
        "\"",         "\"\\x\"", "\"\\ud800\"", "\"a\nb\"", "[1] 2",  "// c\n1",
        "{\"a\":1,}", "nul",     "[1 2]"}) {
    EXPECT_EQ(CodeOf(text), ErrorCode::kInvalidArgument) << text;
  }
}

TEST(ParseJson, RefusesTextThatIsNotUtf8) {
  for (const char* text :
       {"\"\xff\"", "\"\xc3\"", "\"\xc0\xaf\"", "\"\xed\xa0\x80\"",
        "{\"\xfe\":1}", "\"\xf5\x80\x80\x80\""}) {
    EXPECT_EQ(CodeOf(text), ErrorCode::kInvalidArgument);
  }
}

TEST(ParseJson, RefusesAKeyThatIsThereTwiceAtAnyDepth) {
  EXPECT_EQ(CodeOf(R"({"a":1,"a":1})"), ErrorCode::kInvalidArgument);
  EXPECT_EQ(CodeOf(R"([{"x":{"a":1,"b":2,"a":3}}])"),
            ErrorCode::kInvalidArgument);
  EXPECT_TRUE(ParseJson(R"([{"a":1},{"a":{"a":2}}])"));
}

TEST(ParseJson, RefusesMoreBytesThanAllowedWithoutParsingThem) {
  JsonLimits limits;
  limits.max_bytes = 10;
  const auto parsed = ParseJson("[1,2,3,4,5,6]", limits);
  ASSERT_FALSE(parsed);
  EXPECT_EQ(parsed.error().code, ErrorCode::kTooLarge);
}

TEST(ParseJson, RefusesMoreValuesThanAllowed) {
  JsonLimits limits;
  limits.max_values = 4;
  EXPECT_TRUE(ParseJson("[1,{},[]]", limits));
  for (const char* text : {"[1,2,3,4]", "[[[[[]]]]]", "{\"a\":[1,2,3]}"}) {
    const auto parsed = ParseJson(text, limits);
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().code, ErrorCode::kTooLarge) << text;
  }
}

TEST(ParseJson, ReadsManyKeysInLinearTime) {
  std::string text = "{";
  for (int i = 0; i < 60'000; ++i) {
    text += (i > 0 ? ",\"" : "\"") + std::to_string(i) + "\":0";
  }
  EXPECT_EQ(ParseJson(text + "}").value().size(), 60'000u);
}

TEST(ParseJson, NeverCrashesOnMutatedInput) {
  const std::string seed =
      R"({"name":"mug","parts":[{"label":"body","tasks":{"use":"x"}}],)"
      R"("topology":[["body","handle"]],"n":[1.5e3,-0,true,null]})";
  Random random(2);
  for (int round = 0; round < 20'000; ++round) {
    std::string text = seed;
    for (int k = random.NextIndex(6); k >= 0; --k) {
      const auto at =
          static_cast<size_t>(random.NextIndex(static_cast<int>(text.size())));
      switch (random.NextIndex(3)) {
        case 0:
          text[at] = static_cast<char>(random.NextIndex(256));
          break;
        case 1:
          text.erase(at, 1);
          break;
        default:
          text.insert(at, 1, seed[at % seed.size()]);
      }
    }
    const auto parsed = ParseJson(text);
    if (parsed) {
      EXPECT_TRUE(ParseJson(DumpJson(*parsed)));
    }
  }
}

TEST(JsonFields, NamesTheFirstFaultByItsPath) {
  const Json json = ParseJson(R"({"a":{"b":"x"},"c":2})").value();
  JsonFields inner(json["a"], "a");
  double number = 1.0;
  inner.Read("b", number);
  EXPECT_EQ(number, 1.0);
  ASSERT_FALSE(inner.Finish());
  EXPECT_EQ(inner.Finish().error().field, "a.b");
  EXPECT_THAT(inner.Finish().error().message, HasSubstr("must be a number"));
}

TEST(JsonFields, RefusesMembersThatNobodyAskedFor) {
  const Json json = ParseJson(R"({"a":1,"b":2})").value();
  JsonFields fields(json, "");
  double number = 0.0;
  fields.Read("a", number);
  const auto finished = fields.Finish();
  ASSERT_FALSE(finished);
  EXPECT_EQ(finished.error().field, "b");
  EXPECT_EQ(finished.error().hint, "known: a");
}

TEST(JsonFields, WholeNumbersNeverWrapAround) {
  const Json json =
      ParseJson(R"({"a":4294967297,"b":1e30,"c":1.5,"d":-1,"e":7})").value();
  for (const char* name : {"a", "b", "c", "d"}) {
    JsonFields fields(json, "");
    int number = 3;
    fields.ReadInteger(name, number, 0, 1000);
    EXPECT_TRUE(fields.failed()) << name;
    EXPECT_EQ(number, 3);
  }
  JsonFields fields(json, "");
  int number = 3;
  fields.ReadInteger("e", number, 0, 1000);
  EXPECT_EQ(number, 7);
}

TEST(JsonFields, SeedsTakeAllSixtyFourBits) {
  const Json json =
      ParseJson(R"({"a":18446744073709551615,"b":18446744073709551616,"c":-1})")
          .value();
  uint64_t seed = 0;
  JsonFields fields(json, "");
  fields.ReadSeed("a", seed);
  EXPECT_EQ(seed, std::numeric_limits<uint64_t>::max());
  fields.ReadSeed("b", seed);
  EXPECT_TRUE(fields.failed());
  JsonFields negative(json, "");
  negative.ReadSeed("c", seed);
  EXPECT_TRUE(negative.failed());
}

}  // namespace
}  // namespace graspdb
