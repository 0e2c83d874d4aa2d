#include "server/jobs/data_folder.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "server/codec/input_json.h"
#include "server/files.h"
#include "server/jobs/sub_context.h"

namespace graspdb {
namespace {

namespace fs = std::filesystem;

// The folders in a folder that hold a file of that name, in order.
std::vector<fs::path> FindFoldersWith(const fs::path& folder,
                                      const std::string& file) {
  std::vector<fs::path> found;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    if (fs::exists(entry.path() / file)) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

// The same error, with the file's name before it.
Error InFile(const fs::path& file, Error error) {
  error.message = file.string() + ": " + error.message;
  return error;
}

// Every file of the hand's folder beside the URDF and hand.json, as the URDF
// would name it.
Result<HandFiles> ReadHandFolder(const fs::path& folder) {
  HandFiles files;
  GRASPDB_TRY(annotations, ReadFileBytes(folder / "hand.json"));
  files.annotations = std::move(annotations);
  const auto head = HandFileFromJson(files.annotations);
  if (!head) return InFile(folder / "hand.json", head.error());
  GRASPDB_TRY(urdf, ReadFileBytes(folder / head->urdf));
  files.urdf = std::move(urdf);
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension();
    if (extension == ".obj" || extension == ".stl" || extension == ".ply") {
      names.push_back(fs::relative(entry.path(), folder).string());
    }
  }
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) {
    GRASPDB_TRY(bytes, ReadFileBytes(folder / name));
    files.meshes.emplace_back(name, std::move(bytes));
  }
  return files;
}

Result<void> AddCategory(Service& service, const StoredCategory& category) {
  const auto added = service.AddCategory(category);
  if (added) return {};
  if (added.error().code != ErrorCode::kConflict) return added.error();
  const auto updated = service.UpdateCategory(
      category.name, [&](const StoredCategory&) -> Result<StoredCategory> {
        return category;
      });
  return updated ? Result<void>() : Result<void>(updated.error());
}

Result<ImportOrder> ReadExample(const fs::path& folder,
                                const std::string& category,
                                const CategoryExample& example) {
  ImportOrder order;
  order.role = ObjectRole::kExample;
  order.category = category;
  order.name = example.name;
  order.file_name = fs::path(example.mesh).filename().string();
  GRASPDB_TRY(bytes, ReadFileBytes(folder / example.mesh));
  order.bytes = std::move(bytes);
  if (example.labels.empty()) return order;
  GRASPDB_TRY(text, ReadFileBytes(folder / example.labels));
  auto labels = FaceLabelsFromJson(text);
  if (!labels) return InFile(folder / example.labels, labels.error());
  order.face_labels = std::move(*labels);
  return order;
}

// An example of the folder and where its mesh lies, for messages.
struct FolderExample {
  fs::path mesh;
  std::string object_id;
};

Result<std::vector<FolderExample>> ImportCategory(Service& service,
                                                  const fs::path& folder,
                                                  ExecutionContext& context) {
  const fs::path head = folder / "category.json";
  GRASPDB_TRY(text, ReadFileBytes(head));
  const auto file = CategoryFileFromJson(text);
  if (!file) return InFile(head, file.error());
  if (const auto added = AddCategory(service, file->category); !added) {
    return InFile(head, added.error());
  }
  context.ReportProgress("category " + file->category.name, 0.0);
  std::vector<FolderExample> examples;
  for (const CategoryExample& example : file->examples) {
    GRASPDB_TRY(order, ReadExample(folder, file->category.name, example));
    SubContext importing(context, example.name, 0.0, 0.0);
    const auto imported = service.ImportObject(order, importing.context());
    if (!imported) return InFile(folder / example.mesh, imported.error());
    examples.push_back({folder / example.mesh, imported->object.id});
  }
  for (const CategoryExample& novel : file->novel) {
    if (!fs::exists(folder / novel.mesh)) {
      return Error{ErrorCode::kInvalidArgument,
                   (folder / novel.mesh).string() + " does not exist.",
                   "correct " + head.string()};
    }
  }
  return examples;
}

}  // namespace

Result<std::vector<StoredGraspSpace>> Populate(Service& service,
                                               const PopulateOrder& order,
                                               ExecutionContext& context) {
  if (!fs::is_directory(order.folder)) {
    return Error{ErrorCode::kInvalidArgument,
                 order.folder + " is not a folder.",
                 "name one with hands/ and a folder per category"};
  }
  const fs::path root(order.folder);
  for (const fs::path& folder : FindFoldersWith(root / "hands", "hand.json")) {
    GRASPDB_TRY(files, ReadHandFolder(folder));
    const auto hand = service.AddHand(files, context);
    if (!hand) return InFile(folder, hand.error());
    context.ReportProgress("hand " + hand->hand.name, 0.0);
  }
  std::vector<FolderExample> examples;
  for (const fs::path& folder : FindFoldersWith(root, "category.json")) {
    const auto& wanted = order.categories;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(),
                                     folder.filename()) == wanted.end()) {
      continue;
    }
    GRASPDB_TRY(imported, ImportCategory(service, folder, context));
    examples.insert(examples.end(), imported.begin(), imported.end());
  }
  std::vector<StoredGraspSpace> spaces;
  const double count = static_cast<double>(examples.size());
  for (size_t i = 0; order.learn && i < examples.size(); ++i) {
    LearnOrder lesson;
    lesson.object_id = examples[i].object_id;
    lesson.hands = order.hands;
    lesson.parameters = order.parameters;
    lesson.seed = order.seed;
    SubContext learning(context, examples[i].mesh.filename().string(),
                        static_cast<double>(i) / count,
                        static_cast<double>(i + 1) / count);
    const auto learned = service.LearnObject(lesson, learning.context());
    if (!learned) return InFile(examples[i].mesh, learned.error());
    spaces.insert(spaces.end(), learned->begin(), learned->end());
  }
  return spaces;
}

}  // namespace graspdb
