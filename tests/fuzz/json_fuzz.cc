// JSON bodies and category files: whatever comes is an answer or an error that
// says what is wrong.

#include "engine/parameters/parameters.h"
#include "server/codec/input_json.h"
#include "server/codec/json.h"
#include "server/codec/order_json.h"
#include "server/codec/parameters_json.h"
#include "tests/fuzz/fuzz_target.h"

namespace graspdb::fuzz {
namespace {

template <class T>
void Expect(const Result<T>& result) {
  if (!result) Require(!result.error().message.empty());
}

// A category of two parts that touch, changed by whatever comes.
void ExpectPatch(const std::string& text) {
  StoredCategory category;
  category.parts = {{"body", {}, {}}, {"handle", {}, {}}};
  category.adjacency = {{0, 1}};
  const auto patched = PatchCategory(category, text);
  Expect(patched);
  if (!patched) return;
  const auto num_parts = static_cast<int>(patched->parts.size());
  for (const auto& [a, b] : patched->adjacency) {
    Require(a >= 0 && a < num_parts && b >= 0 && b < num_parts && a != b);
  }
}

}  // namespace

std::vector<std::string> MakeSeeds() {
  return {
      R"({"name":"mug","title":"Mugs","parts":[{"label":"body","tasks":{"use":"hold it"}},{"label":"handle"}],"topology":[["body","handle"]],"settings":{"samples":500}})",
      R"({"parts":["body"],"hands":["barrett-bh8-280"],"seed":3,"parameters":{"swarm":{"particles":40}}})",
      R"({"labels":["body","handle","body"]})",
      R"({"label":"handle"})",
      R"({"parts":[{"label":"handle","keep_free":{"use":"it burns"}}]})",
      R"({"settings":{"samples":200,"unary_sigma":0.2},"seed":1})",
      R"({"preset":"paper","contact":{"friction":0.4},"replan":{"iterations":10}})",
      R"({"name":"mug","title":"Mugs","parts":[{"label":"body"}],"topology":[],"examples":[{"mesh":"a.obj","labels":"a.json"}],"novel":[{"name":"b","mesh":"b.obj"}]})",
      R"({"category":"mug","parts":["body"],"stage":"assembly","limit":10,"again":true})",
      R"({"labels_bytes":13,"role":"example","category":"mug","learn":false})",
      R"({"mesh":{"units":"mm"},"category":"auto","count":5,"stage":"transfer"})",
      "[[[[[[1e3,-0.5,\"\\u00e4\",null,true]]]]]]"};
}

}  // namespace graspdb::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace graspdb;
  using namespace graspdb::fuzz;
  const std::string text(AsText(data, size));
  if (const auto json = ParseJson(text)) {
    const std::string dumped = DumpJson(*json);
    const auto again = ParseJson(dumped);
    Require(again.has_value() && DumpJson(*again) == dumped);
  } else {
    Require(!json.error().message.empty());
  }
  Expect(CategoryFromJson(text));
  ExpectPatch(text);
  Expect(CategoryFileFromJson(text));
  Expect(FaceLabelsFromJson(text));
  Expect(HandFileFromJson(text));
  Expect(PartLabelFromJson(text));
  Expect(SegmentOrderFromJson(text));
  Expect(LearnOrderFromJson(text));
  Expect(VerifyOrderFromJson(text));
  Expect(StoredImportOrderFromJson(text, text));
  Expect(StoredSegmentOrderFromJson(text));
  Expect(StoredLearnOrderFromJson(text));
  Expect(StoredTransferOrderFromJson(text, text));
  Expect(SegmentationFromJson(text, {}));
  if (const auto parameters = ParametersFromJson(text, {})) {
    const std::string canonical = ParametersToJson(*parameters);
    const auto again = ParametersFromJson(canonical, {});
    Require(again.has_value() && ParametersToJson(*again) == canonical);
  }
  return 0;
}
