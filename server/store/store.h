#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "server/orders.h"
#include "server/records.h"

namespace graspdb {

struct ObjectFilter {
  std::string category;
  std::optional<ObjectRole> role;
};

struct TransferFilter {
  std::string category;
  std::string object_id;
};

struct GraspSpaceFilter {
  std::string category;
  std::string part_label;
  std::string hand;
  std::string object_id;
};

/** What tells a stored grasp from all others, and from itself before a
 simulator judged it. */
struct GraspKey {
  std::string id;
  std::string object_id;  ///< Ids come again with a transfer done again.
  std::optional<double> physical;
};

using CategoryChange =
    std::function<Result<StoredCategory>(const StoredCategory&)>;

struct AddedCategory {
  StoredCategory category;
  bool created{false};  ///< False when it was stored before.
};

/** What a new object is stored with. `record.id` and `record.created_at` are
 given by the store. Parts and their solids run in parallel; both are empty for
 an object without parts. */
struct NewObject {
  StoredObject record;
  std::string bytes;  ///< The file as uploaded.
  ObjectMeshes meshes;
  std::vector<StoredPart> parts;  ///< `id` and `object_id` are given.
  std::vector<Part> solids;
};

/** The database: one SQLite file, see schema/README.md. What a call
 acknowledges has reached the disk. Every function may be called from any
 thread; writes follow one another, reads run beside them on a consistent
 snapshot.
 Every function may fail with kStorage (disk full, locked, corrupt, closed).
 Find… answers kNotFound, with what is known in the hint. */
class Store {
 public:
  enum class OpenMode { kOpenOrCreate, kMustExist };

  /** Opens a database file, creating or upgrading it where needed. A file that
   is not ours, newer than this program or corrupt is refused with kStorage and
   is not written to.
   @param path  A file in an existing folder; ":memory:" is not accepted. */
  static Result<std::unique_ptr<Store>> Open(
      const std::string& path, OpenMode mode = OpenMode::kOpenOrCreate);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  const std::string& path() const;
  /** The number of the last migration applied. */
  int schema_version() const;

  // ---- Categories -----------------------------------------------------------
  /** The same category a second time changes nothing.
   @retval kConflict when another has its name. */
  Result<AddedCategory> InsertCategory(const StoredCategory& category);
  /** Replaces title, parts, adjacency and segmentation settings by what
   `change` makes of them; nobody else writes meanwhile.
   @retval kNotFound; kConflict when labels change although objects use them;
     and as `change`. */
  Result<StoredCategory> UpdateCategory(const std::string& name,
                                        const CategoryChange& change);
  Result<StoredCategory> FindCategory(const std::string& name) const;
  Result<Page<StoredCategory>> ListCategories(const PageRequest& page) const;
  /** @retval kConflict when it has objects and cascade is false. */
  Result<void> DeleteCategory(const std::string& name, bool cascade);

  // ---- Objects and parts ----------------------------------------------------
  /** Stores all or nothing. The same bytes, units, role and category a second
   time answer with the object already stored and store nothing.
   @param[out] created  Whether it is a new one. */
  Result<StoredObject> InsertObject(const NewObject& object,
                                    bool* created = nullptr);
  Result<StoredObject> FindObject(const std::string& id) const;
  Result<std::optional<StoredObject>> FindObjectByContent(
      const std::string& sha256, const std::string& units, ObjectRole role,
      const std::string& category) const;
  /** In the order of creation. */
  Result<Page<StoredObject>> ListObjects(const ObjectFilter& filter,
                                         const PageRequest& page) const;
  /** The file exactly as uploaded. */
  Result<std::string> ReadObjectBytes(const std::string& id) const;
  Result<ObjectMeshes> ReadObjectMeshes(const std::string& id) const;
  using PartIds = std::optional<std::vector<std::string>>;
  /** Replaces an object's category, labels and parts.
   @param instead_of  The parts, in label order, that the new ones were made of.
   @retval kConflict when grasps depend on the parts and cascade is false; the
     grasps, grasp spaces and transfers go with cascade; when the object has
     others than `instead_of`; and when the category's labels have changed. */
  Result<StoredObject> ReplaceParts(
      const std::string& object_id, const std::string& category,
      const StoredSegmentation& segmentation, const ObjectMeshes& labelled,
      const std::vector<StoredPart>& parts, const std::vector<Part>& solids,
      bool cascade, const PartIds& instead_of = {});
  /** A novel object goes with its grasps and transfers.
   @retval kConflict for an example that grasps or transfers depend on, naming
     them, unless cascade. */
  Result<void> DeleteObject(const std::string& id, bool cascade);

  /** In label order. */
  Result<std::vector<StoredPart>> ListParts(const std::string& object_id) const;
  Result<StoredPart> FindPart(const std::string& id) const;
  /** The solids of parts, as ListParts() or FindPart() gave them, in their
   order; their object_faces are faces of the work mesh.
   @retval kConflict when their object was cut anew since. */
  Result<std::vector<Part>> ReadSolids(
      const std::vector<StoredPart>& parts) const;

  // ---- Hands ----------------------------------------------------------------
  /** The same content a second time changes nothing.
   @retval kConflict when the name is taken by another hand. */
  Result<StoredHand> InsertHand(const StoredHand& hand);
  /** With its meshes. */
  Result<StoredHand> FindHand(const std::string& name) const;
  /** Without their meshes, by name. */
  Result<Page<StoredHand>> ListHands(const PageRequest& page) const;

  // ---- Grasp spaces and grasps ----------------------------------------------
  /** Stores the space and its grasps (ids are given). A space with the same
   part, hand, parameters and seed is kept and answered instead. */
  Result<StoredGraspSpace> InsertGraspSpace(const StoredGraspSpace& record,
                                            const GraspSpace& space);
  Result<StoredGraspSpace> FindGraspSpace(const std::string& id) const;
  /** What was learned before for the same question, if anything. */
  Result<std::optional<StoredGraspSpace>> FindLearned(
      const std::string& part_id, const std::string& hand,
      const std::string& parameters_hash, uint64_t seed) const;
  /** In the order of creation. */
  Result<Page<StoredGraspSpace>> ListGraspSpaces(const GraspSpaceFilter& filter,
                                                 const PageRequest& page) const;
  /** The learned values, grasps in the order in which they were learned. */
  Result<GraspSpace> ReadGraspSpace(const std::string& id) const;
  /** @retval kConflict when transfers used its grasps and cascade is false. */
  Result<void> DeleteGraspSpace(const std::string& id, bool cascade);

  Result<StoredGrasp> FindGrasp(const std::string& id) const;
  /** Keeps what a simulator found: grasp ids and 0..1. Unknown ids are passed
   over. */
  Result<void> SetPhysical(
      const std::vector<std::pair<std::string, double>>& verdicts);
  /** @retval kInvalidArgument for a cursor of another query. */
  Result<Page<StoredGrasp>> QueryGrasps(const GraspQuery& query) const;
  /** The same without reading the grasps. */
  Result<Page<GraspKey>> QueryGraspKeys(const GraspQuery& query) const;

  // ---- Transfers ------------------------------------------------------------
  /** Stores a transfer with its grasps (their ids are used as given). One with
   the same id is kept and answered instead. Of those of the same inputs that
   were cut only the one with the most grasps stays, until one is whole; it, or
   the whole one, is answered instead of a lesser one. */
  Result<StoredTransfer> InsertTransfer(const StoredTransfer& transfer,
                                        const std::vector<StoredGrasp>& grasps);
  Result<StoredTransfer> FindTransfer(const std::string& id) const;
  /** Newest first. */
  Result<Page<StoredTransfer>> ListTransfers(const TransferFilter& filter,
                                             const PageRequest& page) const;

  // ---- Jobs -----------------------------------------------------------------
  /** @param slow  It takes minutes: kept apart from what someone waits for.
   @param payload  The bytes of a mesh, say; kept until the job ends.
   @param max_queued  Of the slow ones, or of the others.
   A job that ended is forgotten after a week.
   @retval kKeyReused if the key's job asked for something else or carries
     another payload.
   @retval kOverloaded when as many are queued. */
  Result<StoredJob> InsertJob(
      JobKind kind, bool slow, const std::string& request,
      const std::string& payload, const JobTerms& terms,
      int64_t max_queued = std::numeric_limits<int64_t>::max());
  Result<StoredJob> FindJob(const std::string& id) const;
  /** Queued jobs whose deadline has passed fail, and give back their keys: who
   sends the request again means it. @returns them. */
  Result<std::vector<StoredJob>> FailOverdueJobs();
  /** Newest first. */
  Result<Page<StoredJob>> ListJobs(std::optional<JobState> state,
                                   const PageRequest& page) const;
  Result<std::string> ReadJobPayload(const std::string& id) const;
  /** How many there are of each kind and state. */
  Result<std::map<std::pair<JobKind, JobState>, int64_t>> CountJobs() const;
  /** The oldest queued job, slow or not, becomes running; none when there is
   none. */
  Result<std::optional<StoredJob>> ClaimJob(bool slow);
  /** Writes how a job ended: state, result or error, times. A job that has
   ended already is left alone. */
  Result<StoredJob> FinishJob(const StoredJob& job);
  /** Puts running jobs back into the queue.
   @param crashed  They were left by a process that died, perhaps of them: one
     that was begun three times fails instead. Else they were interrupted in
     good order, which does not count. */
  Result<RequeuedJobs> RequeueRunningJobs(bool crashed);

  // ---- Idempotency-Key ------------------------------------------------------
  Result<std::optional<StoredReply>> FindReply(const std::string& key) const;
  /** The first reply under a key stays. Replies older than a day go. */
  Result<void> InsertReply(const StoredReply& reply);

  // ---- Health ---------------------------------------------------------------
  Result<StoreCounts> Count() const;
  /** Writes a consistent copy of the whole database as it is now; readers and
   writers go on meanwhile. It is whole and on the disk, or not there.
   @retval kConflict when there is such a file.
   @retval kCancelled soon after the context is. */
  Result<void> WriteBackup(const std::string& path,
                           const ExecutionContext& context = {}) const;
  /** The size of the database without its log, bytes. */
  Result<int64_t> CalcSize() const;
  /** What the databases of this process hold in memory, bytes. */
  static int64_t CalcMemory();
  /** Reads every page, key and blob. */
  Result<CheckReport> Check() const;

 private:
  struct Impl;
  explicit Store(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace graspdb
