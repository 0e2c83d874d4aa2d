// URDFs, by our own reader around urdfdom, as the helper reads them.

#include "engine/hand/urdf_reader.h"
#include "tests/fuzz/fuzz_target.h"

namespace graspdb::fuzz {

std::vector<std::string> MakeSeeds() {
  const std::string palm =
      "<link name=\"palm\"><collision><origin xyz=\"0 0 0.1\" rpy=\"0 1 0\"/>"
      "<geometry><mesh filename=\"package://h/palm.stl\" scale=\"1 1 1\"/>"
      "</geometry></collision></link>";
  const std::string joint =
      "<link name=\"tip\"/><joint name=\"j\" type=\"revolute\">"
      "<parent link=\"palm\"/><child link=\"tip\"/><axis xyz=\"0 1 0\"/>"
      "<limit lower=\"0\" upper=\"2.44\" effort=\"1\" velocity=\"2\"/>"
      "<origin xyz=\"0.05 0 0\" rpy=\"1.57 0 0\"/></joint>";
  return {"<robot name=\"hand\">" + palm + "</robot>",
          "<?xml version=\"1.0\"?><robot name=\"hand\">" + palm + joint +
              "</robot>",
          "<!DOCTYPE r [<!ENTITY e SYSTEM \"file:///etc/passwd\">]>"
          "<robot name=\"&e;\">" +
              palm + joint + "<joint name=\"k\" type=\"prismatic\"/></robot>"};
}

}  // namespace graspdb::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace graspdb;
  using namespace graspdb::fuzz;
  const auto tree = ReadUrdf(std::string(AsText(data, size)));
  if (tree) {
    Require(CheckHandTree(*tree).has_value());
  } else {
    Require(!tree.error().message.empty());
  }
  return 0;
}
