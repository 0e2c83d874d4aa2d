#include "server/bench/bench_items.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "server/codec/input_json.h"
#include "server/files.h"
#include "server/jobs/data_folder.h"

namespace graspdb {
namespace {

namespace fs = std::filesystem;

// So many novel objects of a category are rows of the paper's tables.
constexpr size_t kPaperRows = 2;

Result<void> CollectNovel(const PaperBenchOrder& order,
                          const std::string& category,
                          std::vector<BenchItem>& items) {
  const fs::path folder = fs::path(order.data) / category;
  GRASPDB_TRY(text, ReadFileBytes(folder / "category.json"));
  GRASPDB_TRY(file, CategoryFileFromJson(text));
  for (size_t i = 0; i < file.novel.size(); ++i) {
    if (order.quick && i > 0) break;
    BenchItem item;
    item.group = i < kPaperRows ? "paper" : "further";
    item.number = i < kPaperRows ? static_cast<int>(i) + 1 : 0;
    item.category = category;
    item.name = file.novel[i].name;
    GRASPDB_TRY(bytes, ReadFileBytes(folder / file.novel[i].mesh));
    item.mesh.bytes = std::move(bytes);
    item.mesh.file_name = fs::path(file.novel[i].mesh).filename();
    items.push_back(std::move(item));
  }
  return {};
}

BenchItem MakeCloudItem(const BenchItem& mug, const std::string& view) {
  BenchItem item;
  item.group = "cloud";
  item.category = mug.category;
  item.name = mug.name + ", " + view;
  item.mesh.file_name = "cloud.xyz";
  return item;
}

Result<void> CollectObjects(const PaperBenchOrder& order,
                            const std::string& category,
                            std::vector<BenchItem>& items) {
  std::vector<fs::path> files;
  std::error_code code;
  for (const auto& entry :
       fs::directory_iterator(fs::path(order.objects) / category, code)) {
    const std::string extension = entry.path().extension();
    for (const char* known :
         {".obj", ".stl", ".ply", ".off", ".glb", ".gltf", ".dae"}) {
      if (extension == known) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    BenchItem item;
    item.group = "objects";
    item.category = category;
    item.name = file.stem();
    GRASPDB_TRY(bytes, ReadFileBytes(file));
    item.mesh.bytes = std::move(bytes);
    item.mesh.file_name = file.filename();
    item.mesh.units = order.units;
    items.push_back(std::move(item));
  }
  return {};
}

}  // namespace

Result<std::vector<BenchItem>> CollectBenchItems(const PaperBenchOrder& order) {
  std::vector<BenchItem> items;
  for (const std::string& category : order.categories) {
    GRASPDB_TRY_VOID(CollectNovel(order, category, items));
  }
  const auto first_mug = std::find_if(
      items.begin(), items.end(),
      [](const BenchItem& item) { return item.category == "mug"; });
  if (first_mug != items.end() && !order.quick) {
    const BenchItem mug = *first_mug;
    items.push_back(MakeCloudItem(mug, "all around"));
    items.push_back(MakeCloudItem(mug, "one side"));
  }
  if (order.objects.empty()) return items;
  for (const std::string& category : order.categories) {
    GRASPDB_TRY_VOID(CollectObjects(order, category, items));
  }
  return items;
}

}  // namespace graspdb
