#include "server/cli/program.h"

#include <cstdio>

#include <fmt/format.h>

#include "server/codec/parameters_json.h"
#include "server/files.h"

namespace graspdb {

DecoderOptions MakeDecoderOptions(const Options& options) {
  DecoderOptions decoder;
  decoder.helper = options.decoder;
  decoder.allow_unsandboxed = options.allow_unsandboxed;
  return decoder;
}

Result<std::unique_ptr<Service>> Program::MakeService(
    const std::string& db, Store::OpenMode mode) const {
  GRASPDB_TRY(store, Store::Open(db, mode));
  ServiceOptions service;
  service.threads = options_.threads;
  service.max_mesh_bytes = options_.max_mesh_bytes;
  service.max_queued_jobs = options_.max_queued_jobs;
  service.max_backups = options_.max_backups;
  return std::make_unique<Service>(
      std::move(store), std::make_unique<Decoder>(MakeDecoderOptions(options_)),
      service);
}

Result<Service*> Program::OpenService(Store::OpenMode mode) {
  if (service_) return service_.get();
  GRASPDB_TRY(service, MakeService(options_.db, mode));
  service_ = std::move(service);
  return service_.get();
}

Result<Backend*> Program::OpenBackend() {
  if (options_.server.empty()) {
    GRASPDB_TRY(service, OpenService(Store::OpenMode::kMustExist));
    backend_ = MakeLocalBackend(*service);
  } else {
    GRASPDB_TRY(remote, MakeRemoteBackend(options_.server));
    backend_ = std::move(remote);
  }
  return backend_.get();
}

int Program::Print(
    const std::string& json,
    const std::function<std::string(const std::string&)>& report) {
  const std::string text = options_.json ? json + "\n" : report(json);
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) == 0) return kSuccess;
  fmt::print(stderr, "graspdb: Standard output cannot be written.\n");
  return kUserError;
}

Result<Parameters> ReadParameters(const std::string& given) {
  if (given.empty() || given == "default") return MakeDefaultParameters();
  if (given == "paper") return MakePaperParameters();
  if (given.front() == '{') return ParametersFromJson(given, Parameters());
  GRASPDB_TRY(text, ReadFileBytes(given));
  return ParametersFromJson(text, Parameters());
}

Result<void> ReadMesh(const std::string& path, ImportOrder& order) {
  GRASPDB_TRY(bytes, ReadFileBytes(path));
  order.bytes = std::move(bytes);
  if (path != "-") order.file_name = CutFolders(path);
  return {};
}

}  // namespace graspdb
