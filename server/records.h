#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/admission/cloud_report.h"
#include "engine/base/result.h"
#include "engine/grasp_engine.h"
#include "engine/parameters/parameters.h"
#include "server/category.h"

/** @file
 What the database keeps, as plain values: shared by store (rows), codec (JSON)
 and jobs (verbs), and knowing none of them. SI units; frame O is the object's
 own frame. Times are RFC 3339 UTC with milliseconds. Ids are UUIDv7 for what a
 user creates and content hashes (32 hex digits) for what follows from it. */

namespace graspdb {

/** One page of a list, in the list's order. */
template <class T>
struct Page {
  std::vector<T> items;
  std::string next_cursor;  ///< Opaque; empty on the last page.
};

struct PageRequest {
  int limit{100};      ///< 1..1000.
  std::string cursor;  ///< From the page before; empty for the first.
};

enum class ObjectRole { kExample, kNovel };

/** How an object came by its parts. */
struct StoredSegmentation {
  /** "labels" (given by the user), "transfer" or "shape_diameter"; empty when
   the object has not been segmented. */
  std::string method;
  std::string verdict;     ///< "matched", "unsure" or "foreign".
  std::string example_id;  ///< The example it was aligned to; may be empty.
  RigidTransform X_NE;     ///< That example's frame in the object's …
  double scale{1.0};       ///< … after scaling by this.
  double residual{0.0};    ///< Squared rms radii.
  double similarity{0.0};  ///< 0..1.
  std::vector<std::string> warnings;

  bool operator==(const StoredSegmentation&) const = default;
};

/** What a point cloud told of its object. */
struct StoredCloud {
  CloudReport report;
  double seen_share{0.0};  ///< Of the surface that points support, 0..1.

  bool operator==(const StoredCloud&) const = default;
};

struct StoredObject {
  std::string id;      ///< UUIDv7.
  std::string sha256;  ///< Of the original bytes, 64 hex digits.
  ObjectRole role{ObjectRole::kNovel};
  std::string category;       ///< May be empty: of no category.
  std::string name;           ///< For people; may be empty.
  std::string file_name;      ///< As uploaded; may be empty.
  std::string format;         ///< "obj", "glb", "pcd", ….
  std::string units;          ///< "m", "mm", "cm", "in", or "file": its own.
  int64_t num_bytes{0};       ///< Of the original file.
  int num_triangles{0};       ///< Of the canonical mesh.
  int num_work_triangles{0};  ///< Of the mesh that grasps are searched on.
  Eigen::Vector3d box_min{Eigen::Vector3d::Zero()};  ///< m.
  Eigen::Vector3d box_max{Eigen::Vector3d::Zero()};  ///< m.
  MassProperties mass;
  std::vector<std::string> repairs;
  std::optional<StoredCloud> cloud;  ///< Unset: it came as a mesh.
  StoredSegmentation segmentation;
  std::string created_at;
};

/** A stored object E beside the mesh N that it was searched by. */
struct SimilarObject {
  StoredObject object;
  double similarity{0.0};  ///< 1 for a copy, 0 for the wholly unlike.
  double residual{0.0};    ///< Of the alignment, squared rms radii.
  double scale{1.0};       ///< E is scaled by this about its origin …
  RigidTransform X_NE;     ///< … and lies so in frame N.
};

/** An object's meshes, both in frame O. Labels index the category's parts and
 are empty as long as the object is not segmented. */
struct ObjectMeshes {
  TriangleMesh canonical;  ///< Decoded and repaired, full resolution.
  std::vector<int> canonical_labels;
  TriangleMesh work;  ///< What grasps are searched on; often the same.
  std::vector<int> work_labels;
  std::vector<Eigen::Vector3d> cloud;  ///< Points that they go by, if any …
  CloudReport cloud_report;            ///< … and what was found of them.

  bool operator==(const ObjectMeshes&) const = default;
};

/** A part of an object. Its solid is read apart, see Store::ReadPart(). */
struct StoredPart {
  std::string id;  ///< Content hash of object, label and faces.
  std::string object_id;
  std::string label;
  int label_index{0};
  std::vector<int> faces;             ///< Faces of the canonical mesh.
  double area{0.0};                   ///< Of the surface without the cut, m².
  double volume{0.0};                 ///< Of the closed solid, m³.
  double confidence{1.0};             ///< 0..1.
  std::vector<std::string> adjacent;  ///< Labels of the parts it touches.
};

/** A hand as data. `annotations` is hand.json's text; see codec/hand_json.h. */
struct StoredHand {
  std::string name;
  std::string title;
  std::string sha256;  ///< Of urdf, annotations and meshes: the hand's content.
  std::string urdf;
  std::string annotations;
  /** What the URDF refers to, by the name used there, m in the link's frame. */
  std::vector<std::pair<std::string, TriangleMesh>> meshes;
  std::string created_at;
};

struct StoredGraspSpace {
  std::string id;  ///< Content hash of part, hand, parameters and seed.
  std::string object_id;
  std::string part_id;
  std::string part_label;
  std::string category;
  std::string hand;
  std::string parameters;       ///< Canonical JSON, all of them.
  std::string parameters_hash;  ///< Content hash of `parameters`.
  uint64_t seed{1};
  std::string engine_version;
  int num_grasps{0};
  int num_support_vectors{0};
  int configurations_tried{0};
  double coverage{0.0};  ///< 0..1.
  std::vector<LearningRound> curve;
  double seconds{0.0};                      ///< It took to learn …
  double configuration_space_seconds{0.0};  ///< … the configuration space.
  std::string created_at;
};

/** Where a stored grasp comes from. */
enum class GraspStage {
  kLearned,   ///< Of an example's grasp space.
  kTransfer,  ///< Transferred to a novel object's part.
  kAssembly,  ///< Transferred and valid on the whole object.
};

struct StoredGrasp {
  std::string id;  ///< Content hash of origin, index and stage.
  GraspStage stage{GraspStage::kLearned};
  int index{0};  ///< Among the grasps of its space or transfer.
  std::string object_id;
  std::string part_id;
  std::string part_label;
  std::string category;
  std::string hand;
  Grasp grasp;  ///< In the object's frame O.
  /** Per contact of `grasp`, the image on this object (Eq. 4) of the source's
   contact by the same link, the nearest one, if there is any; empty for a
   learned grasp. */
  std::vector<std::optional<Eigen::Vector3d>> targets_O;
  double example_epsilon{0.0};     ///< The source's, at the same stage.
  double open_close_epsilon{0.0};  ///< The baseline's; 0 when it fails.
  std::optional<double> robust;    ///< 0..1; unknown for learned grasps.
  std::optional<double> grip;      ///< Likewise.
  std::optional<double> physical;  ///< 0..1; unknown until verified.
  double penetration{0.0};         ///< m.
  /** The gap, m, between the hand and each other part of the object. */
  std::map<std::string, double> clearances;
  // Provenance.
  std::string grasp_space_id;   ///< Its own, or its source's.
  std::string transfer_id;      ///< Empty for a learned grasp.
  std::string source_grasp_id;  ///< Empty for a learned grasp.
  std::string engine_version;
  std::string parameters_hash;
  uint64_t seed{1};
};

/** Clearances by label index, by name: without the held part's and those of
 absent parts. */
std::map<std::string, double> NameClearances(
    const std::vector<double>& clearances,
    const std::vector<std::string>& labels, const std::string& held);

/** The id of grasp `index` of a grasp space or transfer. */
std::string MakeGraspId(const std::string& origin_id, GraspStage stage,
                        int index);

/** How an example's part lies on a novel one (Sec. V-A). */
struct StoredContactMap {
  std::string id;  ///< Content hash of transfer and parts.
  std::string transfer_id;
  std::string example_part_id;
  std::string novel_part_id;
  std::string part_label;
  PartAlignment alignment;
};

/** What became of one source grasp. */
struct StoredAttempt {
  std::string source_grasp_id;
  std::string part_id;  ///< Of the novel object.
  std::string part_label;
  TransferOutcome transfer{TransferOutcome::kNoCorrespondence};
  TransferOutcome assembly{TransferOutcome::kNoCorrespondence};
  std::string transferred_grasp_id;  ///< Empty when it failed there.
  std::string assembled_grasp_id;    ///< Empty when it failed there.
  double example_epsilon{0.0};
  double example_epsilon_whole{0.0};
  double open_close_epsilon_part{0.0};
  double open_close_epsilon_whole{0.0};
};

/** One transfer, whole. */
struct StoredTransfer {
  /** Content hash of meshes, grasp spaces, hand, parameters, seed and choice of
   parts and sources. */
  std::string id;
  std::string object_id;   ///< The novel object.
  std::string example_id;  ///< The example it was transferred from.
  std::string category;
  std::string hand;
  GraspStage stage{GraspStage::kAssembly};  ///< The stage asked for.
  int sources_per_part{40};
  std::vector<std::string> part_labels;  ///< Those that grasps are wanted for.
  std::vector<std::string> keep_free;    ///< Those that the hand keeps off.
  std::string parameters;                ///< Canonical JSON.
  std::string parameters_hash;
  uint64_t seed{1};
  std::string engine_version;
  double similarity{0.0};  ///< Of object and example, 0..1.
  bool complete{true};     ///< False when the deadline cut it.
  /** Of the transfer of the same inputs that tries all sources to an end. */
  std::string inputs_id;
  /** Sources were tried until so many grasps were sure; unset: all were. */
  std::optional<int> enough;
  std::vector<StoredAttempt> attempts;
  std::vector<StoredContactMap> contact_maps;
  std::vector<std::string> warnings;
  std::vector<std::pair<std::string, double>> seconds;  ///< Per stage.
  std::string created_at;
};

/** The name in StoredTransfer::seconds of what a stage took of one core for a
 part. */
std::string MakeCoreStage(const std::string& stage, const std::string& label);

/** Everything that an answer to POST /v1/grasps tells, see codec. */
struct TransferAnswer {
  StoredTransfer transfer;
  StoredObject object;
  std::vector<StoredPart> parts;
  std::vector<StoredGrasp> grasps;  ///< Of the stage asked for, best first.
  std::shared_ptr<const HandModel> hand;
};

enum class JobKind { kImport, kLearn, kTransfer, kSegment, kVerify };
inline constexpr std::array kJobKinds{JobKind::kImport, JobKind::kLearn,
                                      JobKind::kTransfer, JobKind::kSegment,
                                      JobKind::kVerify};
enum class JobState { kQueued, kRunning, kSucceeded, kFailed, kCancelled };

struct StoredJob {
  std::string id;  ///< UUIDv7.
  JobKind kind{JobKind::kTransfer};
  JobState state{JobState::kQueued};
  double progress{0.0};  ///< 0..1.
  std::string stage;     ///< What it is doing, in words.
  std::string request;   ///< The order as JSON, without the bytes of a mesh.
  /** What a job that succeeded made: the id of a transfer (kTransfer) or of the
   object (kImport, kLearn, kSegment); empty for kVerify. */
  std::string result_id;
  std::optional<Error> error;
  std::optional<double> eta_seconds;  ///< Known while it runs.
  /** Grasps that a running transfer has found so far. */
  std::optional<int64_t> grasps_found;
  /** When it is to have ended, in milliseconds of Unix time. */
  std::optional<int64_t> deadline;
  std::string created_at;
  std::string started_at;   ///< Empty until then.
  std::string finished_at;  ///< Empty until then.

  bool Overdue(int64_t now) const {
    return state == JobState::kQueued && deadline && now >= *deadline;
  }
  bool Finished() const {
    return state != JobState::kQueued && state != JobState::kRunning;
  }
};

/** What became of jobs that were running when their process ended. */
struct RequeuedJobs {
  int num_queued{0};                ///< Begin again.
  std::vector<StoredJob> given_up;  ///< Failed: they were begun too often.
};

/** kDeadlineExceeded. */
Error MakeTimedOut();

/** What was once answered to a request with an Idempotency-Key. */
struct StoredReply {
  std::string key;
  std::string request_sha256;  ///< Of method, path, query and body.
  int status{200};
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;
};

/** A copy of the whole database. */
struct StoredBackup {
  std::string name;  ///< Of its file.
  int64_t bytes{0};
  std::string sha256;
  std::string created_at;
};

/** How many rows there are of each kind. */
struct StoreCounts {
  int64_t categories{0};
  int64_t objects{0};
  int64_t parts{0};
  int64_t hands{0};
  int64_t grasp_spaces{0};
  int64_t grasps{0};
  int64_t transfers{0};
  int64_t jobs_unfinished{0};

  bool operator==(const StoreCounts&) const = default;
};

/** What a check of the whole database found. */
struct CheckReport {
  std::vector<std::string> problems;  ///< One sentence each; empty when sound.
  StoreCounts counts;
  int64_t blobs_checked{0};
};

// Names on the wire and in the database, both ways. The parsers answer
// kInvalidArgument naming what is accepted.
const char* ToString(ErrorCode code);    // invalid_argument …, as errors.yaml
const char* ToString(ObjectRole role);   // example, novel
const char* ToString(GraspStage stage);  // learned, transfer, assembly
const char* ToString(JobKind kind);      // import, learn, …
const char* ToString(JobState state);    // queued … cancelled
const char* ToString(SegmentationVerdict verdict);
Result<ErrorCode> ParseErrorCode(const std::string& text);
Result<ObjectRole> ParseObjectRole(const std::string& text);
Result<GraspStage> ParseGraspStage(const std::string& text);
Result<JobKind> ParseJobKind(const std::string& text);
Result<JobState> ParseJobState(const std::string& text);
Result<TransferOutcome> ParseTransferOutcome(const std::string& text);

/** Metres per unit of "m", "mm", "cm" or "in".
 @retval kInvalidArgument for any other. */
Result<double> ParseUnits(const std::string& units);

}  // namespace graspdb
