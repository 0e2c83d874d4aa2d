#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/parameters/parameters.h"
#include "server/records.h"

/** @file
 What users ask for, as plain values: filled by routes and command line, carried
 out by jobs/service.h, written as JSON into the jobs table. */

namespace graspdb {

inline constexpr char kDefaultHand[] = "barrett-bh8-280";

/** What goes with any job. */
struct JobTerms {
  /** When not empty: a job with the same key is answered instead of a new one.
   */
  std::string idempotency_key{};
  /** How long it may take from now on, waiting included, s. A transfer then
   answers what it has found; all else fails with kDeadlineExceeded. */
  std::optional<double> deadline{};
};

/** A mesh file to be stored as an object. */
struct ImportOrder {
  std::string bytes;
  std::string file_name;  ///< Helps to guess the format; may be empty.
  std::string format;     ///< "obj", "glb", …; empty: guess.
  std::string units;      ///< "m", "mm", "cm", "in"; empty: the file's.
  ObjectRole role{ObjectRole::kNovel};
  std::string category;  ///< Empty: none; "auto": the most similar one.
  std::string name;      ///< For people; may be empty.
  /** One label per face of the file, for a mesh that needs no repair; empty:
   segment by the category's examples. */
  std::vector<std::string> face_labels;
  uint64_t seed{1};
  /** Only for SubmitImport() of an example: learn afterwards, for every part
   and hand. */
  bool learn{true};
};

struct LearnOrder {
  std::string object_id;
  std::vector<std::string> part_labels;  ///< Empty: all.
  std::vector<std::string> hands;        ///< Empty: all stored.
  Parameters parameters;
  uint64_t seed{1};
};

/** POST /v1/grasps. */
struct TransferOrder {
  /** Used when object_id is empty; its role, category and learn are ignored. */
  ImportOrder mesh;
  std::string object_id;  ///< A stored object instead of a mesh.
  /** As in ImportOrder; empty for a stored object: its own. Required for a
   mesh. */
  std::string category;
  std::vector<std::string> part_labels;  ///< Empty: all.
  std::string task;  ///< Parts that serve it; not together with part_labels.
  std::string hand{kDefaultHand};
  std::optional<int> count;  ///< Most grasps to return, 1..1000; unset: all.
  /** With `count`: all sources are tried, not only until so many are sure. */
  bool exhaustive{false};
  int sources{40};  ///< Source grasps per part, 1..1000.
  GraspStage stage{GraspStage::kAssembly};  ///< kTransfer or kAssembly.
  Parameters parameters;  ///< contact.friction is what the request asks for.
  uint64_t seed{1};
};

struct SegmentOrder {
  std::string object_id;
  std::string category;  ///< Empty: its own; "auto": the most similar one.
  /** JSON of segmentation settings that replace those of the category, by the
   names of GET /v1/parameters; may be empty. */
  std::string settings;
  /** One label per face of the canonical mesh, instead of segmenting. */
  std::vector<std::string> face_labels;
  uint64_t seed{1};
  bool cascade{false};  ///< Grasps that depend on the old parts go.
};

/** Which stored grasps are wanted. Empty fields do not filter. */
struct GraspQuery {
  enum class Sort {
    kEpsilon,  ///< Highest eps first.
    kHybrid,   ///< Lowest measure of Eq. (1) first.
    kRobust,   ///< Highest share first, unknown last.
    kNewest,   ///< Latest stored first.
    kMerit,    ///< What holds in a simulator first, then the surest grip.
  };
  std::string category;
  std::vector<std::string> part_labels;  ///< Any of these.
  std::vector<std::string> keep_free;    ///< Parts that the hand keeps …
  double min_clearance{0.0};             ///< … so far off, m.
  std::string hand;
  std::string object_id;
  std::string grasp_space_id;
  std::string transfer_id;
  std::optional<GraspStage> stage;
  std::optional<double> min_epsilon;
  bool held{false};  ///< Only what a simulator has found to hold every push.
  Sort sort{Sort::kEpsilon};
  PageRequest page;
};

inline constexpr int kMostVerified = 10'000;

/** POST /v1/verifications: which stored grasps a simulator judges. */
struct VerifyOrder {
  GraspQuery query;   ///< Which; its page is of no account.
  int limit{0};       ///< Most grasps, best first; 0: all, not as a job.
  bool again{false};  ///< Those as well that have a verdict.
};

/** Which stored objects a search by shape compares with. */
struct ShapeQuery {
  std::string category;            ///< Empty: any.
  std::optional<ObjectRole> role;  ///< Unset: any.
  int limit{10};                   ///< Most answers, 1..100.
};

}  // namespace graspdb
