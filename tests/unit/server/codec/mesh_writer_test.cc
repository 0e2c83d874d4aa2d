#include "server/codec/mesh_writer.h"

#include <cstring>

#include <gtest/gtest.h>

#include "tests/support/stored_records.h"
#include "tests/support/workshop.h"

namespace graspdb {
namespace {

// Values of the file's bytes from `offset` on.
template <class T>
T At(const std::string& bytes, size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

TEST(MeshWriter, ObjReadsBackToTheSameMesh) {
  const TriangleMesh mesh = MakePlainBox({0.1, 1.0 / 3.0, 1e-7});
  EXPECT_EQ(workshop::ParseObj(WriteMesh(mesh, MeshFormat::kObj)), mesh);
}

TEST(MeshWriter, StlHasTheSizeAndCornersThatItsFormatSays) {
  const TriangleMesh mesh = MakePlainBox({0.5, 0.25, 0.125});
  const std::string bytes = WriteMesh(mesh, MeshFormat::kStl);
  ASSERT_EQ(bytes.size(), 84u + 50u * 12u);
  EXPECT_EQ(At<uint32_t>(bytes, 80), 12u);
  for (int f = 0; f < 12; ++f) {
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 3; ++i) {
        const size_t offset =
            84 + 50 * static_cast<size_t>(f) +
            4 * (3 + 3 * static_cast<size_t>(k) + static_cast<size_t>(i));
        EXPECT_EQ(At<float>(bytes, offset),
                  static_cast<float>(mesh.corner(f, k)[i]));
      }
    }
  }
}

TEST(MeshWriter, PlyKeepsDoubles) {
  const TriangleMesh mesh = MakePlainBox({0.1, 0.2, 0.3});
  const std::string bytes = WriteMesh(mesh, MeshFormat::kPly);
  const size_t body = bytes.find("end_header\n") + 11;
  ASSERT_EQ(bytes.size(), body + 8 * 24 + 12 * 13);
  EXPECT_EQ(At<double>(bytes, body + 24 * 7), 0.1);
  EXPECT_EQ(At<uint8_t>(bytes, body + 8 * 24), 3);
  EXPECT_EQ(At<int32_t>(bytes, body + 8 * 24 + 1), mesh.triangles()[0].x());
}

}  // namespace
}  // namespace graspdb
