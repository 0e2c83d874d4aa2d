#include "server/decode/decode_protocol.h"

#include <limits>

#include <gtest/gtest.h>

#include "engine/base/random.h"
#include "tests/support/mesh_files.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

DecodeAnswer MakeAnswer() {
  return DecodeAnswer{workshop::MakeBox({0.1, 0.2, 0.3}, 2),
                      workshop::MakeBox({0.1, 0.2, 0.3}),
                      {"welded 2 vertices", "filled 1 hole with 2 faces"},
                      "OBJ",
                      "seccomp"};
}

HandTree MakeTree() {
  HandTree tree;
  tree.links.resize(2);
  tree.links[0].name = "palm";
  HandTree::Link& finger = tree.links[1];
  finger.name = "finger";
  finger.parent = 0;
  finger.joint.name = "knuckle";
  finger.joint.type = JointType::kPrismatic;
  finger.joint.X_PJ = {
      Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()).toRotationMatrix(),
      {0.01, 0.02, 0.03}};
  finger.joint.axis_J = Eigen::Vector3d::UnitY();
  finger.joint.lower = -0.1;
  finger.joint.upper = 0.2;
  finger.joint.mimicked = "other";
  finger.joint.ratio = 0.5;
  finger.mass = 0.1;
  finger.p_LcCM = {0.0, 0.0, 0.04};
  finger.pieces.push_back(
      {"finger.obj", {Eigen::Matrix3d::Identity(), {0.0, 0.0, 0.05}}});
  return tree;
}

TEST(DecodeProtocol, CarriesARequest) {
  DecodeRequest request;
  request.format = MeshFormat::kStl;
  request.file_name = "a mug.stl";
  request.metres_per_unit = 0.0254;
  request.limits = {123, 456};
  request.work_triangles = 789;
  std::vector<uint8_t> bytes = EncodeRequest(request);
  bytes.insert(bytes.end(), {1, 2, 3});
  std::span<const uint8_t> mesh;
  const auto parsed = ParseRequest(bytes, &mesh);
  ASSERT_TRUE(parsed.has_value());
  EXPECT_EQ(parsed->format, MeshFormat::kStl);
  EXPECT_EQ(parsed->file_name, request.file_name);
  EXPECT_EQ(parsed->metres_per_unit, request.metres_per_unit);
  EXPECT_EQ(parsed->limits.max_bytes, 123);
  EXPECT_EQ(parsed->limits.max_triangles, 456);
  EXPECT_EQ(parsed->work_triangles, 789);
  EXPECT_EQ(std::vector<uint8_t>(mesh.begin(), mesh.end()),
            (std::vector<uint8_t>{1, 2, 3}));
  request.format.reset();
  const auto unset = ParseRequest(EncodeRequest(request), &mesh);
  ASSERT_TRUE(unset.has_value());
  EXPECT_FALSE(unset->format.has_value());
}

TEST(DecodeProtocol, CarriesAMesh) {
  const DecodeAnswer answer = MakeAnswer();
  const auto parsed = ParseAnswer(EncodeAnswer(answer));
  ASSERT_TRUE(parsed.has_value() && parsed->has_value());
  EXPECT_TRUE((*parsed)->mesh_O == answer.mesh_O);
  EXPECT_TRUE((*parsed)->work_O == answer.work_O);
  EXPECT_EQ((*parsed)->repairs, answer.repairs);
  EXPECT_EQ((*parsed)->format, answer.format);
  EXPECT_EQ((*parsed)->confinement, answer.confinement);
}

TEST(DecodeProtocol, CarriesAHand) {
  const HandTree tree = MakeTree();
  const auto parsed = ParseHandAnswer(EncodeHandAnswer(tree));
  ASSERT_TRUE(parsed.has_value() && parsed->has_value());
  EXPECT_TRUE(**parsed == tree);
}

TEST(DecodeProtocol, RefusesAHandThatCannotBe) {
  HandTree cycle = MakeTree();
  cycle.links[1].parent = 1;
  EXPECT_FALSE(ParseHandAnswer(EncodeHandAnswer(cycle)));
  HandTree stretched = MakeTree();
  stretched.links[1].joint.X_PJ.rotation *= 2.0;
  EXPECT_FALSE(ParseHandAnswer(EncodeHandAnswer(stretched)));
  const std::vector<uint8_t> good = EncodeHandAnswer(MakeTree());
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(ParseHandAnswer(std::span(good).first(size)).has_value());
  }
  for (const uint64_t count : {uint64_t{1} << 40, ~uint64_t{0}}) {
    std::vector<uint8_t> bytes = good;
    std::memcpy(bytes.data() + 4, &count, 8);
    EXPECT_FALSE(ParseHandAnswer(bytes).has_value());
  }
}

TEST(DecodeProtocol, AMeshIsNoHandAndAHandNoMesh) {
  EXPECT_FALSE(ParseHandAnswer(EncodeAnswer(MakeAnswer())));
  EXPECT_FALSE(ParseAnswer(EncodeHandAnswer(MakeTree())));
  EXPECT_FALSE(ParseUrdfRequest(EncodeRequest({})));
  std::vector<uint8_t> bytes = EncodeUrdfRequest();
  bytes.push_back('<');
  const auto urdf = ParseUrdfRequest(bytes);
  ASSERT_TRUE(urdf.has_value());
  EXPECT_EQ(urdf->size(), 1u);
}

TEST(DecodeProtocol, CarriesAnErrorAndMakesItsTextPrintable) {
  const Error error{ErrorCode::kTooLarge, "too\nlarge \xff", "hint", "mesh"};
  const auto parsed = ParseAnswer(EncodeAnswer(error));
  ASSERT_TRUE(parsed.has_value() && !parsed->has_value());
  EXPECT_EQ(parsed->error(),
            (Error{ErrorCode::kTooLarge, "too?large ?", "hint", "mesh"}));
}

TEST(DecodeProtocol, RefusesAnswersThatADecoderMustNotGive) {
  EXPECT_FALSE(ParseAnswer(EncodeAnswer(Error{ErrorCode::kStorage, "no"})));
  EXPECT_FALSE(
      ParseAnswer(EncodeAnswer(Error{static_cast<ErrorCode>(99), "no"})));
  DecodeAnswer open = MakeAnswer();
  open.work_O = TriangleMesh(open.work_O.vertices(), {{0, 1, 2}});
  EXPECT_FALSE(ParseAnswer(EncodeAnswer(open)));
  DecodeAnswer empty = MakeAnswer();
  empty.mesh_O = TriangleMesh();
  EXPECT_FALSE(ParseAnswer(EncodeAnswer(empty)));
  DecodeAnswer infinite = MakeAnswer();
  auto vertices = infinite.mesh_O.vertices();
  vertices[3].y() = std::numeric_limits<double>::infinity();
  infinite.mesh_O = TriangleMesh(vertices, infinite.mesh_O.triangles());
  EXPECT_FALSE(ParseAnswer(EncodeAnswer(infinite)));
}

TEST(DecodeProtocol, RefusesIndicesAndCountsOutOfRange) {
  const DecodeAnswer answer = MakeAnswer();
  const std::vector<uint8_t> good = EncodeAnswer(answer);
  // Behind the mark: the count of vertices, these, the count of triangles.
  const std::size_t vertex_count = 4;
  const std::size_t triangle_count =
      vertex_count + 8 + 24 * answer.mesh_O.vertices().size();
  for (const uint64_t count :
       {uint64_t{0}, uint64_t{1} << 40, ~uint64_t{0}, ~uint64_t{0} / 24 + 1}) {
    for (const std::size_t at : {vertex_count, triangle_count}) {
      std::vector<uint8_t> bytes = good;
      std::memcpy(bytes.data() + at, &count, 8);
      EXPECT_FALSE(ParseAnswer(bytes).has_value());
    }
  }
  for (const int index : {-1, answer.mesh_O.num_vertices()}) {
    std::vector<uint8_t> bytes = good;
    std::memcpy(bytes.data() + triangle_count + 8, &index, 4);
    EXPECT_FALSE(ParseAnswer(bytes).has_value());
  }
}

TEST(DecodeProtocol, RefusesEveryTruncationAndAnyAddition) {
  std::vector<uint8_t> answer = EncodeAnswer(MakeAnswer());
  for (std::size_t size = 0; size < answer.size(); ++size) {
    EXPECT_FALSE(ParseAnswer(std::span(answer).first(size)).has_value());
  }
  answer.push_back(0);
  EXPECT_FALSE(ParseAnswer(answer).has_value());
  const std::vector<uint8_t> request = EncodeRequest(DecodeRequest{});
  std::span<const uint8_t> mesh;
  for (std::size_t size = 0; size < request.size(); ++size) {
    EXPECT_FALSE(ParseRequest(std::span(request).first(size), &mesh));
  }
}

TEST(DecodeProtocol, SurvivesRandomBytes) {
  const std::vector<uint8_t> good = EncodeAnswer(MakeAnswer());
  Random random(7);
  for (int i = 0; i < 5000; ++i) {
    std::vector<uint8_t> bytes = good;
    for (int k = random.NextIndex(8); k >= 0; --k) {
      bytes[random.NextIndex(static_cast<int>(bytes.size()))] =
          static_cast<uint8_t>(random.NextBits());
    }
    const auto parsed = ParseAnswer(bytes);
    EXPECT_TRUE(!parsed || !*parsed || IsClosed((*parsed)->mesh_O));
  }
}

}  // namespace
}  // namespace graspdb
