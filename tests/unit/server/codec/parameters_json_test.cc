#include "server/codec/parameters_json.h"

#include <gmock/gmock.h>

#include "engine/base/random.h"
#include "server/codec/json.h"

namespace graspdb {
namespace {

using ::testing::HasSubstr;

// Every field at random within its range.
class Shuffler {
 public:
  explicit Shuffler(Random& random) : random_(random) {}
  template <class Section>
  void operator()(const char*, Section& section) {
    Section::Visit(section, *this);
  }
  void operator()(const char*, bool& value, const ParameterInfo&) {
    value = random_.NextIndex(2) == 0;
  }
  void operator()(const char*, int& value, const ParameterInfo& info) {
    value = static_cast<int>(random_.NextUniform(info.minimum, info.maximum));
    value = std::max(value, static_cast<int>(std::ceil(info.minimum)));
  }
  void operator()(const char*, double& value, const ParameterInfo& info) {
    value = random_.NextUniform(info.minimum, info.maximum);
  }

 private:
  Random& random_;
};

TEST(ParametersJson, AnyParametersComeBackExactly) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    Parameters parameters;
    Shuffler shuffler(random);
    Parameters::Visit(parameters, shuffler);
    const std::string text = ParametersToJson(parameters);
    const auto read = ParametersFromJson(text, Parameters());
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, parameters);
    EXPECT_EQ(ParametersToJson(*read), text);
    const auto settings = SegmentationFromJson(
        SegmentationToJson(parameters.segmentation), SegmentationParameters());
    ASSERT_TRUE(settings);
    EXPECT_EQ(*settings, parameters.segmentation);
  }
}

TEST(ParametersJson, ReplacesOnlyWhatIsNamed) {
  Parameters expected = MakePaperParameters();
  expected.contact.friction = 0.25;
  const auto read = ParametersFromJson(R"({"contact":{"friction":0.25}})",
                                       MakePaperParameters());
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, expected);
}

TEST(ParametersJson, APresetReplacesTheBase) {
  const auto read = ParametersFromJson(
      R"({"preset":"paper","swarm":{"particles":7}})", Parameters());
  ASSERT_TRUE(read);
  Parameters expected = MakePaperParameters();
  expected.swarm.particles = 7;
  EXPECT_EQ(*read, expected);
  EXPECT_EQ(ParametersFromJson(R"({"preset":"best"})", {}).error().field,
            "preset");
}

TEST(ParametersJson, NamesTheFieldAtFaultAndWhatItTakes) {
  const auto error_of = [](const char* text) {
    return ParametersFromJson(text, Parameters()).error();
  };
  const Error range = error_of(R"({"contact":{"friction":-1}})");
  EXPECT_EQ(range.code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(range.field, "contact.friction");
  EXPECT_THAT(range.message, HasSubstr("from 0.01 to 2"));
  EXPECT_EQ(error_of(R"({"contact":{"cone_edges":8.5}})").field,
            "contact.cone_edges");
  EXPECT_EQ(error_of(R"({"mapping":{"scale":1}})").field, "mapping.scale");
  EXPECT_EQ(error_of(R"({"contact":{"colour":1}})").field, "contact.colour");
  EXPECT_EQ(error_of(R"({"weather":{}})").field, "weather");
  EXPECT_EQ(error_of(R"({"contact":3})").field, "contact");
  EXPECT_EQ(error_of(R"([])").code, ErrorCode::kInvalidArgument);
}

TEST(ParametersJson, TheListNamesEveryTunableWithinItsRange) {
  const Json json = ParseJson(DescribeParameters()).value();
  ASSERT_GT(json["items"].size(), 40u);
  for (const Json& item : json["items"]) {
    if (item["value"].is_boolean()) continue;
    EXPECT_LE(item["minimum"].get<double>(), item["value"].get<double>());
    EXPECT_GE(item["maximum"].get<double>(), item["value"].get<double>());
    EXPECT_FALSE(item["source"].get<std::string>().empty());
  }
  EXPECT_EQ(json["items"][0]["name"], "segmentation.by_shape_diameter");
  EXPECT_EQ(json["presets"]["paper"]["mapping"]["scale"], false);
}

}  // namespace
}  // namespace graspdb
