#include "server/cli/populate.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "server/codec/input_json.h"
#include "server/codec/record_json.h"
#include "server/jobs/sub_context.h"

namespace graspdb {
namespace {

namespace fs = std::filesystem;

// As much as a server takes, see ServiceOptions::max_mesh_bytes.
const int64_t kMostFileBytes = ServiceOptions().max_mesh_bytes;

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
  const auto known = service.store().FindCategory(category.name);
  if (!known) {
    const auto added = service.AddCategory(category);
    return added ? Result<void>() : Result<void>(added.error());
  }
  StoredCategory same = *known;
  same.created_at = category.created_at;
  if (same == category) return {};
  const auto updated = service.UpdateCategory(category);
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
                                                  Progress& progress) {
  const fs::path head = folder / "category.json";
  GRASPDB_TRY(text, ReadFileBytes(head));
  const auto file = CategoryFileFromJson(text);
  if (!file) return InFile(head, file.error());
  if (const auto added = AddCategory(service, file->category); !added) {
    return InFile(head, added.error());
  }
  progress.Say(fmt::format("category {}: {} examples", file->category.name,
                           file->examples.size()));
  std::vector<FolderExample> examples;
  for (const CategoryExample& example : file->examples) {
    GRASPDB_TRY(order, ReadExample(folder, file->category.name, example));
    ExecutionContext context;
    const auto imported = service.ImportObject(order, context);
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

Error MakeUnreadable(const std::string& name) {
  return Error{ErrorCode::kInvalidArgument, name + " cannot be read.",
               "check its name and permissions, or use - for standard input"};
}

Result<std::string> ReadBytes(std::FILE* file, const std::string& name) {
  std::string bytes;
  std::array<char, 65536> chunk{};
  while (const size_t count = std::fread(chunk.data(), 1, chunk.size(), file)) {
    bytes.append(chunk.data(), count);
    if (std::ssize(bytes) > kMostFileBytes) {
      return Error{
          ErrorCode::kTooLarge,
          fmt::format("{} has more than {} bytes.", name, kMostFileBytes),
          "reduce it"};
    }
  }
  if (std::ferror(file) != 0) return MakeUnreadable(name);
  return bytes;
}

}  // namespace

Result<std::string> ReadFileBytes(const std::string& path) {
  if (path == "-") return ReadBytes(stdin, "standard input");
  std::error_code code;
  if (fs::is_directory(path, code)) {
    return Error{ErrorCode::kInvalidArgument, path + " is a folder.",
                 "name a file in it"};
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(
      std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) return MakeUnreadable(path);
  return ReadBytes(file.get(), path);
}

Result<std::string> Populate(Service& service, const PopulateOrder& order,
                             Progress& progress) {
  if (!fs::is_directory(order.folder)) {
    return Error{ErrorCode::kInvalidArgument,
                 order.folder + " is not a folder.",
                 "name one with hands/ and a folder per category"};
  }
  const fs::path root(order.folder);
  for (const fs::path& folder : FindFoldersWith(root / "hands", "hand.json")) {
    GRASPDB_TRY(files, ReadHandFolder(folder));
    const auto hand = service.AddHand(files);
    if (!hand) return InFile(folder, hand.error());
    progress.Say("hand " + hand->name);
  }
  std::vector<FolderExample> examples;
  for (const fs::path& folder : FindFoldersWith(root, "category.json")) {
    GRASPDB_TRY(imported, ImportCategory(service, folder, progress));
    examples.insert(examples.end(), imported.begin(), imported.end());
  }
  std::vector<std::string> spaces;
  const double count = static_cast<double>(examples.size());
  for (size_t i = 0; order.learn && i < examples.size(); ++i) {
    LearnOrder lesson;
    lesson.object_id = examples[i].object_id;
    lesson.hands = order.hands;
    lesson.parameters = order.parameters;
    lesson.seed = order.seed;
    ExecutionContext whole([&](const std::string& stage, double share) {
      progress.Report(stage, share);
    });
    SubContext context(whole, examples[i].mesh.filename().string(),
                       static_cast<double>(i) / count,
                       static_cast<double>(i + 1) / count);
    const auto learned = service.LearnObject(lesson, context.context());
    if (!learned) return InFile(examples[i].mesh, learned.error());
    for (const StoredGraspSpace& space : *learned) {
      spaces.push_back(ToJson(space));
    }
  }
  return ListToJson(spaces, "");
}

}  // namespace graspdb
