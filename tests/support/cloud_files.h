#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <Eigen/Core>

#include "tests/support/mesh_files.h"

/** @file
 Point cloud files written in the plainest way, for tests of what reads them. */

namespace graspdb {

using CloudPoints = std::vector<Eigen::Vector3d>;

inline std::string MakePcdHeader(std::size_t points, const std::string& data) {
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
      "FIELDS rgb x y z\nSIZE 4 4 4 4\nTYPE U F F F\nCOUNT 1 1 1 1\n"
      "WIDTH {}\nHEIGHT 1\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS {}\nDATA {}\n",
      points, points, data);
}

inline FileBytes MakeAsciiPcd(const CloudPoints& points) {
  std::string text = MakePcdHeader(points.size(), "ascii");
  for (const Eigen::Vector3d& p : points) {
    text += fmt::format("7 {} {} {}\n", p.x(), p.y(), p.z());
  }
  return ToBytes(text);
}

inline FileBytes MakeBinaryPcd(const CloudPoints& points) {
  FileBytes bytes = ToBytes(MakePcdHeader(points.size(), "binary"));
  for (const Eigen::Vector3d& p : points) {
    AppendValue(bytes, uint32_t{7});
    for (const double x : p) AppendValue(bytes, static_cast<float>(x));
  }
  return bytes;
}

/** Packs by copies of what stands four bytes before, and runs where that
 differs. */
inline FileBytes PackLzf(const FileBytes& plain) {
  FileBytes packed;
  std::size_t at = 0;
  while (at < plain.size()) {
    std::size_t length = 0;
    while (at >= 4 && at + length < plain.size() && length < 264 &&
           plain[at + length] == plain[at + length - 4]) {
      ++length;
    }
    if (length >= 3) {
      const std::size_t code = length - 2;
      packed.push_back(
          static_cast<uint8_t>(std::min<std::size_t>(code, 7) << 5));
      if (code >= 7) packed.push_back(static_cast<uint8_t>(code - 7));
      packed.push_back(3);
      at += length;
      continue;
    }
    packed.push_back(0);
    packed.push_back(plain[at++]);
  }
  return packed;
}

inline FileBytes MakePackedPcd(const CloudPoints& points) {
  FileBytes plain;
  for (std::size_t i = 0; i < points.size(); ++i) {
    AppendValue(plain, uint32_t{7});
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const Eigen::Vector3d& p : points) {
      AppendValue(plain, static_cast<float>(p[axis]));
    }
  }
  const FileBytes packed = PackLzf(plain);
  FileBytes bytes = ToBytes(MakePcdHeader(points.size(), "binary_compressed"));
  AppendValue(bytes, static_cast<uint32_t>(packed.size()));
  AppendValue(bytes, static_cast<uint32_t>(plain.size()));
  bytes.insert(bytes.end(), packed.begin(), packed.end());
  return bytes;
}

inline FileBytes MakePlyPoints(const CloudPoints& points, bool big_endian) {
  FileBytes bytes = ToBytes(
      fmt::format("ply\nformat binary_{}_endian 1.0\nelement vertex {}\n"
                  "property uchar red\nproperty double x\nproperty float y\n"
                  "property float z\nproperty float nx\nend_header\n",
                  big_endian ? "big" : "little", points.size()));
  for (const Eigen::Vector3d& p : points) {
    AppendValue(bytes, uint8_t{9});
    AppendValue(bytes, p.x(), big_endian);
    AppendValue(bytes, static_cast<float>(p.y()), big_endian);
    AppendValue(bytes, static_cast<float>(p.z()), big_endian);
    AppendValue(bytes, 1.0f, big_endian);
  }
  return bytes;
}

inline FileBytes MakeXyz(const CloudPoints& points) {
  std::string text = fmt::format("{}\n# a comment\n", points.size());
  for (const Eigen::Vector3d& p : points) {
    text += fmt::format("{}, {};{} 1 0 0\n", p.x(), p.y(), p.z());
  }
  return ToBytes(text);
}

/** Every encoding that the reader knows, with the file name to give it. */
inline std::vector<std::pair<std::string, FileBytes>> MakeEveryCloud(
    const CloudPoints& points) {
  return {{"ascii.pcd", MakeAsciiPcd(points)},
          {"binary.pcd", MakeBinaryPcd(points)},
          {"packed.pcd", MakePackedPcd(points)},
          {"little.ply", MakePlyPoints(points, false)},
          {"big.ply", MakePlyPoints(points, true)},
          {"a.xyz", MakeXyz(points)}};
}

}  // namespace graspdb
