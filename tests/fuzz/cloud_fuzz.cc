// Point clouds as PLY, PCD and XYZ, by our own reader. The first byte chooses.

#include "engine/admission/point_cloud_reader.h"
#include "tests/fuzz/fuzz_target.h"

namespace graspdb::fuzz {

std::vector<std::string> MakeSeeds() {
  const std::string points = "0 0 0\n0.01 0 0\n0 0.01 0\n0 0 0.01\n";
  std::string binary =
      "Pply\nformat binary_little_endian 1.0\n"
      "element vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  binary += std::string(24, '\1');
  return {"X" + points,
          "Pply\nformat ascii 1.0\ncomment c\nelement vertex 4\n"
          "property float x\nproperty float y\nproperty float z\n"
          "property uchar red\nend_header\n"
          "0 0 0 1\n0.01 0 0 2\n0 0.01 0 3\n0 0 0.01 4\n",
          binary,
          "C# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\n"
          "TYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 4\nHEIGHT 1\n"
          "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA ascii\n"
          "0 0 0 1\n0.01 0 0 2\n0 0.01 0 3\nnan nan nan 4\n"};
}

}  // namespace graspdb::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace graspdb;
  using namespace graspdb::fuzz;
  if (size == 0) return 0;
  const MeshFormat format = data[0] == 'P'   ? MeshFormat::kPly
                            : data[0] == 'C' ? MeshFormat::kPcd
                                             : MeshFormat::kXyz;
  MeshLimits limits;
  limits.max_triangles = 10'000;
  const auto points = ReadPointCloud({data + 1, size - 1}, format, 1.0, limits);
  if (points) {
    for (const Eigen::Vector3d& p : *points) Require(p.allFinite());
  } else {
    Require(!points.error().message.empty());
  }
  return 0;
}
