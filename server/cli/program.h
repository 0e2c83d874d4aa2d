#pragma once

#include <functional>
#include <memory>
#include <string>

#include "engine/base/result.h"
#include "engine/parameters/parameters.h"
#include "server/cli/backend.h"
#include "server/decode/decode_client.h"
#include "server/jobs/service.h"

namespace graspdb {

// Exit statuses.
inline constexpr int kSuccess = 0;
inline constexpr int kDamaged = 1;
inline constexpr int kUserError = 2;

/** What all subcommands share. */
struct Options {
  std::string db{"graspdb.db"};
  std::string server;
  std::string config;
  std::string decoder;
  bool allow_unsandboxed{false};
  int threads{0};
  int64_t max_mesh_bytes{ServiceOptions().max_mesh_bytes};
  int64_t max_queued_jobs{ServiceOptions().max_queued_jobs};
  int max_backups{ServiceOptions().max_backups};
  bool json{false};
};

DecoderOptions MakeDecoderOptions(const Options& options);

/** The program while it runs one subcommand. */
class Program {
 public:
  const Options& options() const { return options_; }
  Options& options() { return options_; }

  /** The database file --db with all verbs, opened once. */
  Result<Service*> OpenService(Store::OpenMode mode);
  /** The verbs on any database file. */
  Result<std::unique_ptr<Service>> MakeService(const std::string& db,
                                               Store::OpenMode mode) const;
  /** The server that --server names, else the database file. */
  Result<Backend*> OpenBackend();

  /** The JSON itself, or what a person reads of it. @returns the status. */
  int Print(const std::string& json,
            const std::function<std::string(const std::string&)>& report);

 private:
  Options options_;
  std::unique_ptr<Service> service_;
  std::unique_ptr<Backend> backend_;
};

/** A preset's name, or JSON, or a file of JSON, over the defaults. */
Result<Parameters> ReadParameters(const std::string& given);

/** @param path  As for ReadFileBytes(). */
Result<void> ReadMesh(const std::string& path, ImportOrder& order);

}  // namespace graspdb
