#include "tests/support/faulty_vfs.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <sqlite3.h>

namespace graspdb {
namespace {

constexpr int64_t kSector = 512;

sqlite3_vfs* real_vfs = nullptr;

// What SQLite holds of an open file; the real one lies right behind it.
struct ShimFile {
  sqlite3_file base;
  FaultyVfs::File* watched;
  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};

ShimFile* AsShim(sqlite3_file* file) {
  return reinterpret_cast<ShimFile*>(file);
}
sqlite3_file* RealOf(sqlite3_file* file) { return AsShim(file)->real(); }
const sqlite3_io_methods& Methods(sqlite3_file* file) {
  return *RealOf(file)->pMethods;
}

// Remembers what the sectors from `begin` to `end` have been at the last flush.
void Remember(sqlite3_file* file, int64_t begin, int64_t end) {
  FaultyVfs::File& watched = *AsShim(file)->watched;
  for (int64_t s = begin / kSector; s * kSector < end; ++s) {
    if (watched.durable.contains(s)) continue;
    std::vector<char> content(kSector, '\0');
    // What lies behind the end of the file reads as zeros.
    Methods(file).xRead(RealOf(file), content.data(), kSector, s * kSector);
    watched.durable[s] = std::move(content);
  }
}

int Close(sqlite3_file* file) { return Methods(file).xClose(RealOf(file)); }

int Read(sqlite3_file* file, void* to, int size, sqlite3_int64 at) {
  if (AsShim(file)->watched != nullptr) {
    if (const int code = FaultyVfs::Get().Begin(FaultyVfs::Call::kRead)) {
      return code;
    }
  }
  return Methods(file).xRead(RealOf(file), to, size, at);
}

int Write(sqlite3_file* file, const void* from, int size, sqlite3_int64 at) {
  if (AsShim(file)->watched != nullptr) {
    if (const int code = FaultyVfs::Get().Begin(FaultyVfs::Call::kChange))
      return code;
    Remember(file, at, at + size);
  }
  return Methods(file).xWrite(RealOf(file), from, size, at);
}

int Truncate(sqlite3_file* file, sqlite3_int64 size) {
  if (AsShim(file)->watched != nullptr) {
    if (const int code = FaultyVfs::Get().Begin(FaultyVfs::Call::kChange))
      return code;
    sqlite3_int64 before = 0;
    Methods(file).xFileSize(RealOf(file), &before);
    Remember(file, size, before);
  }
  return Methods(file).xTruncate(RealOf(file), size);
}

int Sync(sqlite3_file* file, int) {
  FaultyVfs::File* watched = AsShim(file)->watched;
  if (watched == nullptr) return SQLITE_OK;
  if (const int code = FaultyVfs::Get().Begin(FaultyVfs::Call::kChange))
    return code;
  watched->durable.clear();
  sqlite3_int64 size = 0;
  const int code = Methods(file).xFileSize(RealOf(file), &size);
  watched->durable_size = size;
  return code;
}

int FileSize(sqlite3_file* file, sqlite3_int64* size) {
  return Methods(file).xFileSize(RealOf(file), size);
}
int Lock(sqlite3_file* file, int level) {
  return Methods(file).xLock(RealOf(file), level);
}
int Unlock(sqlite3_file* file, int level) {
  return Methods(file).xUnlock(RealOf(file), level);
}
int CheckReservedLock(sqlite3_file* file, int* held) {
  return Methods(file).xCheckReservedLock(RealOf(file), held);
}
int FileControl(sqlite3_file* file, int what, void* with) {
  return Methods(file).xFileControl(RealOf(file), what, with);
}
int SectorSize(sqlite3_file* file) {
  return Methods(file).xSectorSize(RealOf(file));
}
int DeviceCharacteristics(sqlite3_file* file) {
  return Methods(file).xDeviceCharacteristics(RealOf(file));
}
int ShmMap(sqlite3_file* file, int page, int size, int extend,
           void volatile** to) {
  return Methods(file).xShmMap(RealOf(file), page, size, extend, to);
}
int ShmLock(sqlite3_file* file, int offset, int count, int flags) {
  return Methods(file).xShmLock(RealOf(file), offset, count, flags);
}
void ShmBarrier(sqlite3_file* file) { Methods(file).xShmBarrier(RealOf(file)); }
int ShmUnmap(sqlite3_file* file, int remove) {
  return Methods(file).xShmUnmap(RealOf(file), remove);
}

const sqlite3_io_methods kMethods{2,
                                  Close,
                                  Read,
                                  Write,
                                  Truncate,
                                  Sync,
                                  FileSize,
                                  Lock,
                                  Unlock,
                                  CheckReservedLock,
                                  FileControl,
                                  SectorSize,
                                  DeviceCharacteristics,
                                  ShmMap,
                                  ShmLock,
                                  ShmBarrier,
                                  ShmUnmap,
                                  nullptr,
                                  nullptr};

int Open(sqlite3_vfs*, const char* path, sqlite3_file* file, int flags,
         int* flags_out) {
  ShimFile* shim = AsShim(file);
  shim->base.pMethods = nullptr;
  shim->watched = path == nullptr ? nullptr : FaultyVfs::Get().Find(path);
  if (shim->watched != nullptr) {
    if (const int code = FaultyVfs::Get().Begin(FaultyVfs::Call::kOpen)) {
      return code;
    }
  }
  const int code =
      real_vfs->xOpen(real_vfs, path, shim->real(), flags, flags_out);
  if (code != SQLITE_OK) return code;
  shim->base.pMethods = &kMethods;
  if (shim->watched != nullptr && shim->watched->durable.empty()) {
    sqlite3_int64 size = 0;
    Methods(file).xFileSize(shim->real(), &size);
    shim->watched->durable_size = size;
  }
  return SQLITE_OK;
}

}  // namespace

FaultyVfs& FaultyVfs::Get() {
  static FaultyVfs vfs;
  return vfs;
}

FaultyVfs::FaultyVfs() {
  real_vfs = sqlite3_vfs_find(nullptr);
  static sqlite3_vfs shim = *real_vfs;
  shim.zName = "faulty";
  shim.szOsFile = static_cast<int>(sizeof(ShimFile)) + real_vfs->szOsFile;
  shim.xOpen = Open;
  sqlite3_vfs_register(&shim, 1);
}

void FaultyVfs::Watch(const std::string& folder) {
  folder_ = folder + "/";
  files_.clear();
  before_change_ = nullptr;
  FailAt(0, 0);
}

FaultyVfs::File* FaultyVfs::Find(const char* path) {
  const std::string name = path;
  if (folder_.empty() || !name.starts_with(folder_)) return nullptr;
  return &files_[name];
}

void FaultyVfs::FailAt(int64_t n, int code, Call call) {
  left_ = n;
  code_ = n > 0 ? code : 0;
  call_ = call;
}

int FaultyVfs::Begin(Call call) {
  if (call == Call::kChange && before_change_) before_change_();
  if (call != call_ || left_ == 0 || --left_ > 0) return 0;
  return code_;
}

void FaultyVfs::WriteImage(const std::string& folder, Random& random) {
  namespace fs = std::filesystem;
  fs::create_directories(folder);
  for (const auto& [path, file] : files_) {
    if (!fs::exists(path)) continue;
    std::ifstream in(path, std::ios::binary);
    std::string content((std::istreambuf_iterator<char>(in)),
                        std::istreambuf_iterator<char>());
    const auto coin = [&random] { return random.NextUniform() < 0.5; };
    const auto durable_size = static_cast<size_t>(file.durable_size);
    if (content.size() != durable_size && coin()) {
      content.resize(durable_size, '\0');
    }
    for (const auto& [sector, before] : file.durable) {
      const auto at = static_cast<size_t>(sector * kSector);
      if (at >= content.size() || coin()) continue;
      std::memcpy(content.data() + at, before.data(),
                  std::min(before.size(), content.size() - at));
    }
    std::ofstream(folder + "/" + fs::path(path).filename().string(),
                  std::ios::binary)
        << content;
  }
}

}  // namespace graspdb
