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

/** Which stored objects a search by shape compares with. */
struct ShapeQuery {
  std::string category;            ///< Empty: any.
  std::optional<ObjectRole> role;  ///< Unset: any.
  int limit{10};                   ///< Most answers, 1..100.
};

}  // namespace graspdb
