#include "server/jobs/segmentation.h"

#include <gmock/gmock.h>

#include "tests/support/workshop.h"

namespace graspdb {
namespace {

using ::testing::Each;
using ::testing::SizeIs;

// A box, four times as fine as the mesh that grasps are searched on; one part.
ObjectMeshes MakeFineBox() {
  ObjectMeshes meshes;
  meshes.canonical = workshop::MakeBox({0.1, 0.1, 0.1}, 4);
  meshes.work = workshop::MakeBox({0.1, 0.1, 0.1}, 2);
  return meshes;
}

StoredCategory MakeBoxes() {
  StoredCategory category;
  category.name = "box";
  category.parts = {{"body", {}, {}}};
  return category;
}

TEST(SegmentByLabels, CarriesTheLabelsToTheMeshThatIsSearched) {
  const ObjectMeshes meshes = MakeFineBox();
  const std::vector<std::string> labels(meshes.canonical.num_triangles(),
                                        "body");
  const auto segmented = SegmentByLabels(MakeBoxes(), meshes, labels, {});
  ASSERT_TRUE(segmented) << segmented.error().message;
  EXPECT_THAT(segmented->meshes.work_labels, Each(0));
  EXPECT_THAT(segmented->meshes.work_labels,
              SizeIs(meshes.work.num_triangles()));
  ASSERT_THAT(segmented->parts, SizeIs(1));
  EXPECT_EQ(segmented->parts[0].label, "body");
}

TEST(SegmentByLabels, StopsWhenItIsCancelled) {
  const ObjectMeshes meshes = MakeFineBox();
  const std::vector<std::string> labels(meshes.canonical.num_triangles(),
                                        "body");
  ExecutionContext context;
  context.Cancel();
  const auto segmented = SegmentByLabels(MakeBoxes(), meshes, labels, context);
  ASSERT_FALSE(segmented);
  EXPECT_EQ(segmented.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace graspdb
