#include "server/jobs/backup_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "server/files.h"
#include "server/ids.h"

namespace graspdb {
namespace {

namespace fs = std::filesystem;

constexpr char kPrefix[] = "graspdb-";
constexpr char kChecksum[] = ".sha256";
constexpr char kUnfinished[] = ".new";  // Ends before it is whole.

Error MakeFolderError(const std::string& path, const std::error_code& error) {
  return {ErrorCode::kStorage,
          "The folder " + path + " cannot be used: " + error.message() + ".",
          "check its permissions"};
}

Error MakeWriteError(int number) {
  return {
      ErrorCode::kStorage,
      std::string("A backup cannot be written: ") + std::strerror(number) + ".",
      "make room"};
}

// 2024-05-01T12:00:00.000Z as graspdb-20240501T120000.000Z.db, and back.
std::string MakeName(std::string time) {
  std::erase_if(time, [](char c) { return c == '-' || c == ':'; });
  return kPrefix + time + ".db";
}

std::string ReadTime(const std::string& name) {
  constexpr size_t kBegin = sizeof(kPrefix) - 1;
  const std::string t = name.substr(kBegin, 20);
  return t.substr(0, 4) + "-" + t.substr(4, 2) + "-" + t.substr(6, 5) + ":" +
         t.substr(11, 2) + ":" + t.substr(13);
}

constexpr char kSample[] = "graspdb-20240501T120000.000Z.db";
constexpr size_t kNameLength = sizeof(kSample) - 1;

bool IsName(const std::string& name) {
  if (name.size() != kNameLength) return false;
  return std::equal(name.begin(), name.end(), kSample, [](char c, char sample) {
    const bool digit = sample >= '0' && sample <= '9';
    return digit ? c >= '0' && c <= '9' : c == sample;
  });
}

// What a server that was killed has left behind.
void RemoveUnfinished(const std::string& folder) {
  std::error_code error;
  std::vector<fs::path> old;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename();
    const std::string backup = name.substr(0, kNameLength);
    std::error_code unknown;
    const bool unfinished = name.find(kUnfinished) != std::string::npos ||
                            (name == backup + kChecksum &&
                             !fs::exists(fs::path(folder) / backup, unknown));
    if (unfinished && IsName(backup)) old.push_back(entry->path());
  }
  for (const fs::path& path : old) fs::remove(path, error);
}

// A backup's name and checksum, beside it and on the disk.
bool WriteChecksum(const std::string& file, const StoredBackup& backup) {
  const std::string draft = file + kChecksum + kUnfinished;
  std::ofstream out(draft);
  out << backup.sha256 << "  " << backup.name << "\n";
  out.close();
  return out && SyncToDisk(draft) &&
         std::rename(draft.c_str(), (file + kChecksum).c_str()) == 0;
}

}  // namespace

BackupFolder::BackupFolder(std::string path, int most)
    : path_(std::move(path)), most_(most) {
  GRASPDB_EXPECTS(most_ >= 1);
}

Result<StoredBackup> BackupFolder::Add(const Store& store,
                                       const ExecutionContext& context) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) {
    return Error{ErrorCode::kOverloaded, "A backup is being made already.",
                 "ask again when it is done"};
  }
  std::error_code error;
  const bool fresh = fs::create_directories(path_, error);
  if (error) return MakeFolderError(path_, error);
  if (fresh) SyncToDisk(fs::absolute(path_).parent_path());
  RemoveUnfinished(path_);
  StoredBackup backup;
  backup.created_at = FormatNow();
  backup.name = MakeName(backup.created_at);
  const std::string file = fs::path(path_) / backup.name;
  const std::string draft = file + kUnfinished;
  GRASPDB_TRY_VOID(store.WriteBackup(draft, context));
  const auto sha256 = CalcFileSha256(draft);
  if (!sha256) return MakeWriteError(errno);
  backup.bytes = static_cast<int64_t>(fs::file_size(draft, error));
  if (error) return MakeWriteError(error.value());
  backup.sha256 = *sha256;
  // A backup counts when it has both; the checksum comes first.
  if (!WriteChecksum(file, backup) ||
      std::rename(draft.c_str(), file.c_str()) != 0 || !SyncToDisk(path_)) {
    return MakeWriteError(errno);
  }
  GRASPDB_TRY_VOID(RemoveOldest(backup.name));
  return backup;
}

Result<void> BackupFolder::RemoveOldest(const std::string& newest) const {
  GRASPDB_TRY(all, List());
  // By name, though the clock may have been turned back since the others.
  std::erase_if(all,
                [&](const StoredBackup& one) { return one.name == newest; });
  std::error_code error;
  for (size_t i = static_cast<size_t>(most_) - 1; i < all.size(); ++i) {
    const std::string old = fs::path(path_) / all[i].name;
    fs::remove(old + kChecksum, error);
    fs::remove(old, error);
  }
  return {};
}

Result<std::vector<StoredBackup>> BackupFolder::List() const {
  std::vector<StoredBackup> backups;
  std::error_code error;
  if (!fs::exists(path_, error)) return backups;
  for (fs::directory_iterator entry(path_, error), end; !error && entry != end;
       entry.increment(error)) {
    StoredBackup backup;
    backup.name = entry->path().filename();
    if (!IsName(backup.name)) continue;
    // One without its checksum is not done, or somebody else's.
    std::ifstream checksum(entry->path().string() + kChecksum);
    if (!(checksum >> backup.sha256)) continue;
    std::error_code gone;
    backup.bytes = static_cast<int64_t>(entry->file_size(gone));
    if (gone) continue;
    backup.created_at = ReadTime(backup.name);
    backups.push_back(std::move(backup));
  }
  if (error) return MakeFolderError(path_, error);
  std::sort(backups.begin(), backups.end(),
            [](const StoredBackup& a, const StoredBackup& b) {
              return a.name > b.name;
            });
  return backups;
}

}  // namespace graspdb
