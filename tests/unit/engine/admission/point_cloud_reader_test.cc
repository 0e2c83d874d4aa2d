#include "engine/admission/point_cloud_reader.h"

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/cloud_files.h"
#include "tests/support/mesh_files.h"

namespace graspdb {
namespace {

using ::testing::HasSubstr;

// Exact in single precision; much alike, so that packing pays.
CloudPoints MakePoints(int count) {
  CloudPoints points;
  for (int i = 0; i < count; ++i) {
    points.emplace_back(0.125, 0.25 + (i % 5) / 64.0, i / 1024.0);
  }
  return points;
}

TEST(PointCloudReader, ReadsTheSamePointsFromEveryEncoding) {
  const CloudPoints points = MakePoints(300);
  for (const auto& [name, bytes] : MakeEveryCloud(points)) {
    const MeshFormat format = *GuessMeshFormat(bytes, name);
    SCOPED_TRACE(GetName(format));
    EXPECT_EQ(*GuessMeshFormat(bytes, ""), format);
    EXPECT_TRUE(HoldsPointsOnly(bytes, format));
    const auto cloud = ReadPointCloud(bytes, format, 0.5, MeshLimits{});
    ASSERT_TRUE(cloud.has_value()) << cloud.error().message;
    ASSERT_EQ(cloud->size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ((*cloud)[i], 0.5 * points[i]);
    }
  }
}

TEST(PointCloudReader, AMeshHoldsMoreThanPoints) {
  const TriangleMesh mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  EXPECT_FALSE(HoldsPointsOnly(MakeAsciiPly(mesh), MeshFormat::kPly));
  EXPECT_FALSE(HoldsPointsOnly(MakeObj(mesh), MeshFormat::kObj));
  EXPECT_FALSE(HoldsPointsOnly(ToBytes("ply\n"), MeshFormat::kPly));
}

TEST(PointCloudReader, LeavesOutPointsWithoutAPosition) {
  CloudPoints points = MakePoints(10);
  points[3].y() = std::numeric_limits<double>::quiet_NaN();
  points[7].z() = std::numeric_limits<double>::infinity();
  for (const auto& [name, bytes] : MakeEveryCloud(points)) {
    const MeshFormat format = *GuessMeshFormat(bytes, name);
    const auto cloud = ReadPointCloud(bytes, format, 1.0, MeshLimits{});
    ASSERT_TRUE(cloud.has_value()) << cloud.error().message;
    EXPECT_EQ(cloud->size(), 8u) << GetName(format);
  }
}

TEST(PointCloudReader, RefusesEveryTruncationThatLeavesPointsOut) {
  const CloudPoints points = MakePoints(40);
  for (const auto& [name, bytes] : MakeEveryCloud(points)) {
    const MeshFormat format = *GuessMeshFormat(bytes, name);
    if (format == MeshFormat::kXyz) continue;  // Nothing tells how many.
    // A number in text that is cut short is another number.
    for (std::size_t size = 0; size + 16 < bytes.size(); ++size) {
      const FileBytes cut(bytes.begin(), bytes.begin() + size);
      EXPECT_FALSE(ReadPointCloud(cut, format, 1.0, MeshLimits{}))
          << GetName(format) << size;
    }
  }
}

TEST(PointCloudReader, NamesTheLimitThatIsExceeded) {
  MeshLimits limits;
  limits.max_points = 99;
  for (const auto& [name, bytes] : MakeEveryCloud(MakePoints(100))) {
    const MeshFormat format = *GuessMeshFormat(bytes, name);
    const auto cloud = ReadPointCloud(bytes, format, 1.0, limits);
    ASSERT_FALSE(cloud.has_value()) << GetName(format);
    EXPECT_EQ(cloud.error().code, ErrorCode::kTooLarge);
    EXPECT_THAT(cloud.error().message, HasSubstr("the limit is 99"));
  }
}

TEST(PointCloudReader, RefusesWhatIsNoCloudAndNamesTheFormat) {
  FileBytes damaged = MakePackedPcd(MakePoints(100));
  damaged[MakePcdHeader(100, "binary_compressed").size() + 8] = 0xff;
  const std::pair<MeshFormat, FileBytes> cases[] = {
      {MeshFormat::kXyz, {}},
      {MeshFormat::kXyz, ToBytes("hello\n")},
      {MeshFormat::kXyz, ToBytes("1 2\n3 4\n")},
      {MeshFormat::kXyz, ToBytes("# nothing\n")},
      {MeshFormat::kPcd, ToBytes("VERSION 0.7\nDATA ascii\n")},
      {MeshFormat::kPcd, ToBytes("FIELDS x y\nSIZE 4 4\nTYPE F F\n"
                                 "COUNT 1 1\nPOINTS 1\nDATA ascii\n1 2\n")},
      {MeshFormat::kPcd, ToBytes("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n"
                                 "COUNT 1 1 1\nPOINTS 1\nDATA zip\n123")},
      {MeshFormat::kPcd, ToBytes("FIELDS x y z\nSIZE 4 4\nTYPE F F F\n"
                                 "POINTS 1\nDATA ascii\n1 2 3\n")},
      {MeshFormat::kPcd, damaged},
      {MeshFormat::kPly, ToBytes("ply\nformat ascii 1.0\nelement vertex 1\n"
                                 "property float x\nend_header\n1\n")},
      {MeshFormat::kObj, ToBytes("v 1 2 3\n")},
  };
  for (const auto& [format, bytes] : cases) {
    const auto cloud = ReadPointCloud(bytes, format, 1.0, MeshLimits{});
    ASSERT_FALSE(cloud.has_value());
    EXPECT_EQ(cloud.error().code, ErrorCode::kUnusableInput);
    EXPECT_THAT(cloud.error().message, HasSubstr(GetName(format)));
  }
}

TEST(PointCloudReader, AllocatesNothingForCountsThatLie) {
  MeshLimits limits;
  limits.max_points = std::numeric_limits<int64_t>::max();
  for (const char* count : {"4000000000", "9223372036854775807", "-1"}) {
    for (const char* data : {"ascii", "binary", "binary_compressed"}) {
      const std::string text = fmt::format(
          "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
          "POINTS {}\nDATA {}\n0 0 0 0 0 0 0 0\n",
          count, data);
      EXPECT_FALSE(
          ReadPointCloud(ToBytes(text), MeshFormat::kPcd, 1.0, limits));
    }
  }
}

}  // namespace
}  // namespace graspdb
