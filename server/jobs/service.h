#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/admission/mesh_format.h"
#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "engine/parameters/parameters.h"
#include "engine/registration/shape_descriptor.h"
#include "engine/simulation/grasp_simulator.h"
#include "server/files.h"
#include "server/jobs/backup_folder.h"
#include "server/jobs/job_observer.h"
#include "server/jobs/live_grasp.h"
#include "server/lru_cache.h"
#include "server/orders.h"
#include "server/records.h"
#include "server/store/store.h"

namespace graspdb {

class Decoder;
struct DecodeCounts;
class JobRunner;
struct DecodedMesh;

/** GET /v1/grasps: a GraspQuery and what only the category knows. */
struct GraspSearch {
  GraspQuery query;
  std::string task;  ///< Parts that serve it, of query.category or any.
};

/** A hand's files, as in data/hands/<name>. */
struct HandFiles {
  std::string annotations;  ///< hand.json
  std::string urdf;
  /** By the file names that the URDF uses. */
  std::vector<std::pair<std::string, std::string>> meshes;
};

/** A stored hand. */
struct AddedHand {
  StoredHand hand;
  bool created{false};  ///< False when it was stored before.
};

struct ServiceOptions {
  int threads{0};  ///< Of the engine; 0: as many as there are cores.
  int64_t max_mesh_bytes{kMostFileBytes};
  int64_t max_triangles{MeshLimits{}.max_triangles};
  int64_t max_queued_jobs{100};  ///< Beyond it new ones are refused.
  int max_backups{10};           ///< Older ones are removed.
};

/** What an import led to. */
struct ImportResult {
  StoredObject object;
  std::vector<StoredPart> parts;
  bool created{false};  ///< False when the object was stored before.
};

/** How Service::VerifyGrasps() judges. */
struct VerifyOptions {
  PushTest test;
  /** Whether the verdicts are stored. If not, all that are asked for are
   judged. */
  bool keep{true};
};

struct VerifiedGrasp {
  StoredGrasp grasp;
  PhysicalVerdict verdict;
};

using GraspCallback = std::function<void(const StoredGrasp&)>;

/** The verbs of the application, without HTTP: what the server's routes and the
 command line both call. Thread-safe. Each error says in its hint what to do
 next; http/problem.cc maps its code to a status. */
class Service {
 public:
  /** @param decoder  Reads uploaded meshes, see server/decode. */
  Service(std::unique_ptr<Store> store, std::unique_ptr<Decoder> decoder,
          const ServiceOptions& options);
  /** Stops the workers: running jobs go back into the queue. */
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /** Reading and plain rows: lists, Find…, Read…, deletes. */
  Store& store() { return *store_; }
  const Store& store() const { return *store_; }
  const ServiceOptions& options() const { return options_; }

  /** Whether meshes can be decoded, and how the helper is confined. */
  Result<std::string> CheckDecoder() const;
  DecodeCounts CountDecoded() const;
  /** Of what is kept in memory, by name. */
  std::map<std::string, CacheCounts> CountCaches() const;
  /** In the folder DATABASE.backups. */
  BackupFolder& backups() { return backups_; }

  // ---- Immediate verbs ------------------------------------------------------
  /** Checks names and labels, then stores; the same category a second time
   changes nothing.
   @retval kConflict when another has its name. */
  Result<AddedCategory> AddCategory(const StoredCategory& category);
  /** See Store::UpdateCategory(). */
  Result<StoredCategory> UpdateCategory(const std::string& name,
                                        const CategoryChange& change);
  /** Decodes a hand's meshes and its URDF, checks that they make a hand, and
   stores it; the same files a second time change nothing.
   @retval kConflict when another hand has its name.
   @retval kInvalidArgument, kUnusableInput, kTooLarge naming what is wrong. */
  Result<AddedHand> AddHand(const HandFiles& files,
                            const ExecutionContext& context);
  /** The built hand, shared by all callers.
   @retval kCancelled soon after the context is. */
  Result<std::shared_ptr<const HandModel>> FindHandModel(
      const std::string& name, const ExecutionContext& context = {}) const;
  /** The same with its links' search structures, shared, too. */
  Result<std::shared_ptr<const HandShape>> FindHandShape(
      const std::string& name, const ExecutionContext& context = {}) const;

  /** Decodes, segments and stores a mesh. Idempotent in (bytes, units, role,
   category). An object of no category is stored without parts. An example
   without face labels needs another example of its category. */
  Result<ImportResult> ImportObject(const ImportOrder& order,
                                    ExecutionContext& context);
  /** Segments a stored object again, or takes the given labels. */
  Result<ImportResult> Resegment(const SegmentOrder& order,
                                 ExecutionContext& context);
  /** The stored objects whose shapes are the most like a mesh's, which is not
   stored: the nearest by shape descriptor, sorted by how well they align. */
  Result<std::vector<SimilarObject>> SearchByShape(const ImportOrder& order,
                                                   const ShapeQuery& query,
                                                   ExecutionContext& context);
  /** PATCH of a part: its faces get another label of the category. Parts of the
   same label become one. */
  Result<ImportResult> Relabel(const std::string& part_id,
                               const std::string& label, bool cascade);

  /** Learns the grasp space of every part and hand that is not known yet and
   answers them all, known ones included. */
  Result<std::vector<StoredGraspSpace>> LearnObject(const LearnOrder& order,
                                                    ExecutionContext& context);
  /** Maps, replans, assembles, stores; a transfer with the same inputs is
   answered from the store. One that the context's deadline cuts is stored with
   what it found, under ids of its own, until one of the same inputs finds more:
   it answers no request without a deadline.
   @retval kDeadlineExceeded when it passed before anything was found.
   @param on_grasp  Hears of each grasp of the stage asked for as it is found,
     before it is stored: from the computing threads, one at a time. */
  Result<TransferAnswer> TransferGrasps(const TransferOrder& order,
                                        ExecutionContext& context,
                                        const GraspCallback& on_grasp = {});
  /** The answer to a stored transfer. @param count  As in TransferOrder. */
  Result<TransferAnswer> DescribeTransfer(const std::string& transfer_id,
                                          std::optional<int> count) const;

  Result<Page<StoredGrasp>> QueryGrasps(const GraspSearch& search) const;
  /** The same without reading the grasps. */
  Result<Page<GraspKey>> QueryGraspKeys(const GraspSearch& search) const;

  /** Lets a simulator judge stored grasps, best first, and keeps its verdicts,
   object by object. */
  Result<std::vector<VerifiedGrasp>> VerifyGrasps(
      const VerifyOrder& order, ExecutionContext& context,
      const VerifyOptions& options = {});

  // ---- Jobs -----------------------------------------------------------------
  // Submit… checks what can be checked at once (names, ranges, what is
  // learned, how many labels), writes the job to the database and returns it
  // queued.
  Result<StoredJob> SubmitImport(const ImportOrder& order,
                                 const JobTerms& terms = {});
  Result<StoredJob> SubmitLearn(const LearnOrder& order,
                                const JobTerms& terms = {});
  Result<StoredJob> SubmitTransfer(const TransferOrder& order,
                                   const JobTerms& terms = {});
  Result<StoredJob> SubmitSegment(const SegmentOrder& order,
                                  const JobTerms& terms = {});
  Result<StoredJob> SubmitVerify(const VerifyOrder& order,
                                 const JobTerms& terms = {});
  /** The job with its live progress. */
  Result<StoredJob> FindJob(const std::string& id) const;
  Result<Page<StoredJob>> ListJobs(std::optional<JobState> state,
                                   const PageRequest& page) const;
  /** Returns when the job has finished or after the timeout, whichever comes
   first, the job as it then is. */
  Result<StoredJob> WaitForJob(const std::string& id,
                               std::chrono::milliseconds timeout) const;
  /** Returns when the job differs from `seen` in state, stage, progress or
   grasps found, has finished, or after the timeout. */
  Result<StoredJob> WaitForChange(const StoredJob& seen,
                                  std::chrono::milliseconds timeout) const;
  /** What a running transfer has found, in the order of finding, from the
   `first`-th on; empty when it does not run. */
  std::vector<LiveGrasp> ReadLiveGrasps(const std::string& job_id,
                                        size_t first) const;
  /** A queued job is cancelled at once, a running one within moments, one that
   has finished stays as it is. */
  Result<StoredJob> CancelJob(const std::string& id);

  /** Holds an Idempotency-Key until the answer is dropped, so that of many
   requests at once under one key one has an effect.
   @retval kConflict while another holds it. */
  Result<std::shared_ptr<void>> HoldKey(const std::string& key);

  /** Queues what a dead process left running and starts the workers: one for
   all that learns, one for the rest, so that no transfer waits for minutes.
   Only a server calls this. */
  Result<void> StartWorkers(JobObserver observer = {});
  /** Running jobs go back into the queue; returns when the workers have ended.
   Safe to call twice. */
  void StopWorkers();

 private:
  friend class JobRunner;
  static constexpr int64_t kMostSolidBytes = 64 << 20;
  static constexpr int64_t kMostHandBytes = 64 << 20;
  static constexpr int64_t kMostDescriptorBytes = 64 << 20;

  Result<DecodedMesh> DecodeUpload(const ImportOrder& order,
                                   const ExecutionContext& context) const;
  // Of a whole object's working mesh.
  Result<std::shared_ptr<const Solid>> FindWholeSolid(const std::string& id);
  Result<ShapeDescriptor> FindDescriptor(const std::string& id) const;
  // With the defaults filled in.
  Result<ImportOrder> CheckImport(const ImportOrder& order) const;
  Result<TransferOrder> CheckTransfer(const TransferOrder& order) const;
  Result<void> CheckLearn(const LearnOrder& order) const;
  // None when no part serves the task.
  Result<std::optional<GraspQuery>> MakeQuery(const GraspSearch& search) const;
  template <class Item>
  using FindPage = Result<Page<Item>> (Store::*)(const GraspQuery&) const;
  template <class Item>
  Result<Page<Item>> Query(const GraspSearch& search,
                           FindPage<Item> find) const;
  Result<void> CheckQuery(const GraspQuery& query) const;
  Result<StoredJob> Submit(JobKind kind, bool slow, const std::string& request,
                           const std::string& payload, const JobTerms& terms);
  Result<ImportResult> ImportNewObject(const ImportOrder& order,
                                       ExecutionContext& context);
  Result<TransferAnswer> FindOrMakeTransfer(const TransferOrder& order,
                                            ExecutionContext& context,
                                            const GraspCallback& on_grasp);
  Result<StoredObject> FindTransferObject(const TransferOrder& order,
                                          ExecutionContext& context);

  std::unique_ptr<Store> store_;
  std::unique_ptr<Decoder> decoder_;
  BackupFolder backups_;
  ServiceOptions options_;
  mutable std::mutex hand_mutex_;  // Held while a hand is built.
  // A hand never changes.
  mutable LruCache<std::shared_ptr<const HandModel>> hands_{kMostHandBytes};
  mutable LruCache<std::shared_ptr<const HandShape>> hand_shapes_{
      kMostHandBytes};
  // An object's mesh never changes.
  LruCache<std::shared_ptr<const Solid>> whole_solids_{kMostSolidBytes};
  mutable LruCache<ShapeDescriptor> descriptors_{kMostDescriptorBytes};
  std::mutex keys_mutex_;
  std::set<std::string> held_keys_;
  std::unique_ptr<JobRunner> runner_;
};

}  // namespace graspdb
