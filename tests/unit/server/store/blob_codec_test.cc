#include "server/store/blob_codec.h"

#include <limits>

#include <gmock/gmock.h>

#include "tests/support/stored_records.h"

namespace graspdb {
namespace {

using ::testing::ElementsAre;

constexpr int kRounds = 200;

TEST(BlobCodec, MeshesComeBackExactly) {
  Random random(1);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Eigen::Vector3d> vertices(3 + random.NextIndex(40));
    for (Eigen::Vector3d& vertex : vertices) vertex = MakePoint(random);
    std::vector<Eigen::Vector3i> triangles(random.NextIndex(60));
    const int count = static_cast<int>(vertices.size());
    for (Eigen::Vector3i& triangle : triangles) {
      triangle = {random.NextIndex(count), random.NextIndex(count),
                  random.NextIndex(count)};
    }
    const TriangleMesh mesh(vertices, triangles);
    const auto decoded = DecodeMesh(EncodeMesh(mesh));
    ASSERT_TRUE(decoded);
    EXPECT_EQ(*decoded, mesh);
  }
}

TEST(BlobCodec, GraspsComeBackExactlyButForTheirQuality) {
  Random random(2);
  for (int round = 0; round < kRounds; ++round) {
    GraspBlob blob{MakeGrasp(random, random.NextIndex(12)), {}};
    blob.grasp.quality = {};
    for (int i = 0; i < random.NextIndex(5); ++i) {
      if (random.NextIndex(2) == 0) {
        blob.targets_O.push_back(std::nullopt);
      } else {
        blob.targets_O.push_back(MakePoint(random));
      }
    }
    const auto decoded = DecodeGrasp(EncodeGrasp(blob));
    ASSERT_TRUE(decoded);
    EXPECT_EQ(decoded->grasp, blob.grasp);
    EXPECT_EQ(decoded->targets_O, blob.targets_O);
  }
}

TEST(BlobCodec, PartsPosesIndicesAndConfigurationsComeBackExactly) {
  Random random(3);
  for (int round = 0; round < kRounds; ++round) {
    const Part part = MakeNewObject("x", ObjectRole::kNovel).solids[1];
    const auto decoded_part = DecodePart(EncodePart(part));
    ASSERT_TRUE(decoded_part);
    EXPECT_EQ(decoded_part->label, 1);
    EXPECT_EQ(decoded_part->num_surface_faces, 6);
    EXPECT_EQ(decoded_part->object_faces, part.object_faces);
    EXPECT_EQ(decoded_part->solid_O, part.solid_O);

    const RigidTransform pose = MakePose(random);
    const auto decoded_pose = DecodePose(EncodePose(pose));
    ASSERT_TRUE(decoded_pose);
    EXPECT_EQ(*decoded_pose, pose);

    std::vector<int> indices(random.NextIndex(100));
    for (int& index : indices) index = random.NextIndex(1 << 30);
    const auto decoded_indices = DecodeIndices(EncodeIndices(indices));
    ASSERT_TRUE(decoded_indices);
    EXPECT_EQ(*decoded_indices, indices);

    std::vector<HandConfiguration> hands(random.NextIndex(9));
    for (HandConfiguration& hand : hands) {
      hand = {MakePose(random), MakeJoints(random, 4)};
    }
    const auto decoded_hands =
        DecodeConfigurations(EncodeConfigurations(hands));
    ASSERT_TRUE(decoded_hands);
    EXPECT_EQ(*decoded_hands, hands);
  }
}

TEST(BlobCodec, KeepsEveryDoubleEvenTheOddOnes) {
  const double inf = std::numeric_limits<double>::infinity();
  RigidTransform pose;
  pose.translation = {-0.0, 5e-324, inf};
  const auto decoded = DecodePose(EncodePose(pose));
  ASSERT_TRUE(decoded);
  EXPECT_TRUE(std::signbit(decoded->translation.x()));
  EXPECT_EQ(decoded->translation.y(), 5e-324);
  EXPECT_EQ(decoded->translation.z(), inf);
}

// By hand: version 1, kind 2, count 2, then 1 and -2, and the CRC-32 of those
// 14 bytes as zlib.crc32 of Python gives it.
TEST(BlobCodec, WritesTheDocumentedBytes) {
  const std::string bytes = EncodeIndices({1, -2});
  std::vector<int> values;
  for (const char c : bytes) values.push_back(static_cast<unsigned char>(c));
  EXPECT_THAT(values, ElementsAre(1, 2, 2, 0, 0, 0, 1, 0, 0, 0, 0xFE, 0xFF,
                                  0xFF, 0xFF, 0x7d, 0xf4, 0x7e, 0x6a));
}

TEST(BlobCodec, NoticesEveryFlippedBitAndEveryTruncation) {
  Random random(4);
  const std::string bytes = EncodeGrasp({MakeGrasp(random), {std::nullopt}});
  for (size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string damaged = bytes;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
    EXPECT_FALSE(DecodeGrasp(damaged)) << "bit " << bit;
  }
  for (size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(DecodeGrasp(bytes.substr(0, size)));
  }
  EXPECT_FALSE(DecodeGrasp(bytes + '\0'));
}

TEST(BlobCodec, RefusesTheBytesOfAnotherKind) {
  EXPECT_FALSE(DecodeMesh(EncodeIndices({1, 2, 3})));
  EXPECT_FALSE(DecodePart(EncodeMesh(MakePlainBox({1, 1, 1}))));
}

}  // namespace
}  // namespace graspdb
