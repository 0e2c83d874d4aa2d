#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "engine/cspace/active_learner.h"
#include "engine/geometry/solid.h"
#include "engine/hand/hand_shape.h"
#include "engine/parameters/parameters.h"
#include "engine/planning/grasp.h"
#include "engine/segmentation/part.h"
#include "engine/segmentation/part_segmentation.h"
#include "engine/transfer/transfer_outcome.h"

/** @file
 The engine's public face: values in, values out. Segment (see
 part_segmentation.h), Learn, Transfer. All are deterministic: the same request
 gives the same result on any number of threads. */

namespace graspdb {

/** A part's learned grasp space: distinct stable grasps, best eps first. */
struct GraspSpace {
  std::vector<Grasp> grasps;  ///< Quality about the part.
  std::vector<LearningRound> curve;
  std::vector<HandConfiguration> support_vectors;  ///< The collision-free ones.
  int configurations_tried{0};  ///< Hands closed and judged by the swarm.
  /** Per grasp and label: PartSurfaces::CalcClearances() on the example. */
  std::vector<std::vector<double>> clearances;
  double coverage{0.0};  ///< Share of (approach direction) bins reached, 0..1.
  /** Of all that learning took, the configuration space's; not reproducible. */
  double configuration_space_seconds{0.0};

  bool operator==(const GraspSpace&) const = default;
};

struct LearnRequest {
  std::shared_ptr<const HandShape> hand;
  Part part_E;
  LabelledMesh whole_E;  ///< The object that the part was cut from.
  Parameters parameters;
  uint64_t seed{1};
  int threads{0};  ///< 0: as many as there are cores.
};

/** Sec. IV: configuration space, then grasp space, of one part of an example.
 @retval kCancelled, also past a deadline: half a grasp space is none. */
Result<GraspSpace> Learn(const LearnRequest& request,
                         ExecutionContext& context);

/** The whole story of one source grasp. */
struct TransferRecord {
  int part{0};          ///< Index into TransferRequest::novel_parts.
  int source_grasp{0};  ///< Index into that part's source grasp space.
  TransferOutcome transfer{TransferOutcome::kNoCorrespondence};
  TransferOutcome assembly{TransferOutcome::kNoCorrespondence};
  std::optional<Grasp> transferred;  ///< On the part.
  std::optional<Grasp> assembled;    ///< On the whole object.
  /** Where Eq. (4) sends the source grasp's contacts, on the novel object;
   empty where a contact has no target. One per source contact. */
  std::vector<std::optional<Eigen::Vector3d>> targets_N;
  double example_epsilon{0.0};           ///< Source grasp about its part.
  double example_epsilon_whole{0.0};     ///< Closed on its whole; 0: fails.
  double open_close_epsilon_part{0.0};   ///< Baseline; 0 when it fails.
  double open_close_epsilon_whole{0.0};  ///< Baseline; 0 when it fails.
  std::vector<double> transferred_clearances;  ///< As GraspSpace has them.
  std::vector<double> assembled_clearances;
  /** The deadline ended the search: what there is is the best so far, and that
   there is no grasp means nothing. */
  bool cut{false};
  Robustness robust;             ///< Of 32 perturbed copies.
  double penetration{0.0};       ///< Deepest overlap of hand and object, m.
  double transfer_seconds{0.0};  ///< Of one core; not reproducible.
  double assembly_seconds{0.0};  ///< Likewise.
};

/** Sec. V-A: how the example's part lies on the novel one. */
struct PartAlignment {
  RigidTransform X_NE;       ///< The paper's (R*, T*).
  double scale{1.0};         ///< p_N = scale · R p_E + T.
  double residual{0.0};      ///< Mean 6-D deviation, rms radii.
  double mapped_share{0.0};  ///< Samples that pass the consistency check.
};

/** Hears of each record of a result in order, as soon as it and those before it
 have ended: its place in TransferResult::records, and itself; once more of one
 that was tried again. Called from the
 computing threads, one at a time. */
using RecordCallback = std::function<void(int, const TransferRecord&)>;

struct TransferRequest {
  std::shared_ptr<const HandShape> hand;
  std::shared_ptr<const Solid> whole_E;  ///< Whole example object, frame E.
  LabelledMesh novel;                    ///< Whole novel object, frame N.
  std::vector<Part> example_parts;       ///< Those of `whole_E`.
  std::vector<Part> novel_parts;         ///< Those of `novel`.
  /** What a point cloud shows of `novel`; null: it came as a mesh. */
  std::shared_ptr<const SeenSurface> seen_N;
  RigidTransform X_NE;  ///< Whole-object alignment, from segmentation …
  double scale{1.0};    ///< … with its scale.
  /** For each novel part the grasp space of the example part of the same label;
   null for parts that no grasps are wanted for. */
  std::vector<std::shared_ptr<const GraspSpace>> grasp_spaces;
  /** Labels that the hand keeps transfer.min_clearance off, on the example as
   on the novel object. */
  std::vector<int> keep_free;
  int sources_per_part{40};
  /** When set, those that promise most are tried first, the parts in turn, and
   no more once so many grasps hold transfer.sure_grip of their copies: all with
   replan.quick_climb_samples, and if that is not enough those that came nearest
   once more with replan.climb_samples and replan.searches. */
  std::optional<int> enough;
  bool assemble{true};
  Parameters parameters;
  uint64_t seed{1};
  int threads{0};              ///< 0: as many as there are cores.
  RecordCallback on_record{};  ///< May be empty.
};

struct TransferResult {
  std::vector<PartAlignment> alignments;  ///< One per novel part.
  /** Part by part, source by source; as tried when `enough` was set. */
  std::vector<TransferRecord> records;
  bool complete{true};  ///< False when the deadline cut it or it was cancelled.
};

/** Sec. V: maps, replans and assembles source grasps on a novel object. The
 source grasps are drawn by (seed, grasp space) before the novel object is
 looked at, equally from each quartile of eps of those that keep free what must
 be. A deadline of the context ends it with what was found.
 @retval kCancelled. */
Result<TransferResult> Transfer(const TransferRequest& request,
                                ExecutionContext& context);

/** The version of the engine, part of every grasp's provenance. */
const char* EngineVersion();

}  // namespace graspdb
