#include <algorithm>
#include <atomic>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/base/random.h"
#include "engine/base/thread_clock.h"
#include "engine/geometry/surface_sampling.h"
#include "engine/grasp_engine.h"
#include "engine/pipeline/part_clearance.h"
#include "engine/pipeline/source_grasps.h"
#include "engine/planning/grasp_evaluator.h"
#include "engine/planning/perturbed_copies.h"
#include "engine/quality/epsilon_quality.h"
#include "engine/quality/opposed_contacts.h"
#include "engine/quality/wrench_space.h"
#include "engine/registration/surface_alignment.h"
#include "engine/registration/surface_warp.h"
#include "engine/transfer/contact_map.h"
#include "engine/transfer/local_replanner.h"
#include "engine/transfer/open_close.h"

namespace graspdb {
namespace {

// What the streams of random numbers are for.
enum Stream : uint64_t {
  kSources,
  kSamplesE,
  kSamplesN,
  kReplan,
  kAssemble,
  kRobust
};

// A novel part with everything that its source grasps share.
struct PartPair {
  const Part* part_E{nullptr};
  std::unique_ptr<SurfaceIndex> index_E;
  std::unique_ptr<Solid> solid_N;
  SurfaceAlignment alignment;
  std::unique_ptr<ContactMap> map;
};

class Transferrer {
 public:
  Transferrer(const TransferRequest& request, ExecutionContext& context)
      : request_(request),
        parameters_(request.parameters),
        context_(context),
        hand_(*request.hand) {}

  Result<TransferResult> Run() {
    // The forty are fixed before the novel object is looked at.
    TransferResult result;
    for (size_t p = 0; p < request_.grasp_spaces.size(); ++p) {
      if (!request_.grasp_spaces[p]) continue;
      for (const int source : DrawSourceGrasps(
               *request_.grasp_spaces[p], request_.keep_free,
               parameters_.transfer.min_clearance, request_.sources_per_part,
               DeriveSeed(request_.seed, {kSources, p}))) {
        TransferRecord record;
        record.part = static_cast<int>(p);
        record.source_grasp = source;
        result.records.push_back(std::move(record));
      }
    }
    context_.ReportProgress("aligning", 0.0);
    Prepare(result);
    if (context_.Cancelled() && !context_.TimedOut()) {
      return Error{ErrorCode::kCancelled, "the transfer was cancelled"};
    }
    TryAll(result);
    return result;
  }

 private:
  // The novel object, and solids, alignments and contact maps of all wanted
  // parts.
  void Prepare(TransferResult& result) {
    const int count = static_cast<int>(request_.novel_parts.size());
    pairs_.resize(count);
    result.alignments.resize(count);
    ParallelFor(count + 2, [&](int task) {
      if (task == 0) {
        if (request_.assemble) {
          whole_N_ = std::make_unique<Solid>(request_.novel.mesh_O, -1,
                                             request_.seen_N);
        }
      } else if (task == 1) {
        surfaces_N_ = std::make_unique<PartSurfaces>(request_.novel);
      } else if (const int p = task - 2; request_.grasp_spaces[p]) {
        PreparePart(p, result.alignments[p]);
      }
    });
  }

  void PreparePart(int p, PartAlignment& alignment) {
    PartPair& pair = pairs_[p];
    const Part& part_N = request_.novel_parts[p];
    const auto found = std::find_if(
        request_.example_parts.begin(), request_.example_parts.end(),
        [&part_N](const Part& part) { return part.label == part_N.label; });
    if (found == request_.example_parts.end()) return;
    pair.part_E = &*found;
    pair.index_E = std::make_unique<SurfaceIndex>(found->solid_O);
    pair.solid_N = std::make_unique<Solid>(
        part_N.solid_O, part_N.num_surface_faces, request_.seen_N);
    const MappingParameters& mapping = parameters_.mapping;
    const SurfaceSamples samples_E =
        SamplePoissonDisk(found->solid_O, mapping.samples,
                          DeriveSeed(request_.seed, {kSamplesE, uint64_t(p)}),
                          found->num_surface_faces);
    const SurfaceSamples samples_N =
        SamplePoissonDisk(part_N.solid_O, mapping.samples,
                          DeriveSeed(request_.seed, {kSamplesN, uint64_t(p)}),
                          part_N.num_surface_faces);
    AlignmentOptions options;
    options.scale = mapping.scale;
    options.normal_weight = mapping.normal_weight;
    pair.alignment = RefineAlignment(samples_E, samples_N,
                                     CalcStart(*found, mapping.scale), options);
    pair.map = std::make_unique<ContactMap>(
        samples_E, samples_N,
        MoveSamples(*found, samples_E, samples_N, options), *pair.index_E,
        pair.solid_N->index(), mapping);
    alignment = {pair.alignment.X_NE, pair.alignment.scale,
                 pair.alignment.residual, pair.map->CalcMappedShare()};
  }

  // Where the example's samples lie on the novel part.
  SurfaceSamples MoveSamples(const Part& part_E,
                             const SurfaceSamples& samples_E,
                             const SurfaceSamples& samples_N,
                             AlignmentOptions options) const {
    const MappingParameters& mapping = parameters_.mapping;
    options.scale = mapping.affine;
    const SurfaceSamples moved = MapSamples(
        samples_E, RefineAlignment(samples_E, samples_N,
                                   CalcStart(part_E, options.scale), options)
                       .map_NE);
    return WarpSamples(moved, samples_N, mapping);
  }

  // The whole objects' alignment, which a body's handle has turned right; a
  // rigid one keeps the part's centre where the similarity puts it.
  SurfaceAlignment CalcStart(const Part& part_E, bool scale) const {
    SurfaceAlignment start;
    start.X_NE = request_.X_NE;
    start.scale = request_.scale;
    if (scale) return start;
    const Eigen::Vector3d center_E = CalcMassProperties(part_E.solid_O).p_McCM;
    const Eigen::Vector3d center_N = start * center_E;
    start.scale = 1.0;
    start.X_NE.translation = center_N - start.X_NE.rotation * center_E;
    return start;
  }

  // How much is tried for one source; see ReplanOptions.
  struct Effort {
    int climb_samples;
    int searches;
    bool until_sure;

    bool operator==(const Effort&) const = default;
  };

  // All sources; or, when a few sure grasps are enough, all with few tries
  // until there are so many, and only then those that came nearest with more.
  void TryAll(TransferResult& result) {
    std::vector<TransferRecord>& records = result.records;
    const ReplanParameters& replan = parameters_.replan;
    const Effort whole{replan.climb_samples, replan.searches, false};
    if (!request_.enough) {
      Try(records, MakeOrder(records.size()), whole, false, 1.0, result);
      return;
    }
    SortByPromise(records);
    const Effort quick{
        std::min(replan.quick_climb_samples, replan.climb_samples), 1, true};
    const int tried =
        Try(records, MakeOrder(records.size()), quick, false, 0.8, result);
    records.resize(static_cast<size_t>(tried));
    if (found_ >= *request_.enough || quick == whole) return;
    std::vector<int> unsure;
    for (int i = 0; i < tried; ++i) {
      const bool kept_free =
          records[i].transfer != TransferOutcome::kNotKeptFree &&
          records[i].assembly != TransferOutcome::kNotKeptFree;
      if (FindGrasp(records[i]) ? !IsSure(records[i]) : !kept_free) {
        unsure.push_back(i);
      }
    }
    std::stable_sort(unsure.begin(), unsure.end(), [&](int a, int b) {
      return records[a].robust.gripped > records[b].robust.gripped;
    });
    Try(records, unsure, whole, true, 1.0, result);
  }

  static std::vector<int> MakeOrder(size_t count) {
    std::vector<int> order(count);
    std::iota(order.begin(), order.end(), 0);
    return order;
  }

  // Tries records until there are enough sure ones. @returns how many of the
  // order were tried; the other records are as they were. `again`: they have
  // been tried before.
  int Try(std::vector<TransferRecord>& records, const std::vector<int>& order,
          const Effort& effort, bool again, double end,
          TransferResult& result) {
    const auto count = static_cast<int>(order.size());
    std::vector<TransferRecord> tried(order.size());
    const double begin = std::exchange(share_, end);
    const int last = ParallelUntil(
        count,
        [&](int i, const Wanted& wanted) {
          tried[i].part = records[order[i]].part;
          tried[i].source_grasp = records[order[i]].source_grasp;
          TransferOne(tried[i], effort, wanted);
          tried[i].cut = context_.Cancelled();
        },
        [&](int i) {
          TransferRecord& record = records[order[i]];
          if (tried[i].cut) {
            result.complete = false;
            // What was cut short does not replace what there is.
            if (again) return false;
          }
          tried[i].transfer_seconds += record.transfer_seconds;
          tried[i].assembly_seconds += record.assembly_seconds;
          record = std::move(tried[i]);
          if (request_.on_record) request_.on_record(order[i], record);
          if (IsSure(record)) ++found_;
          double share = (i + 1.0) / count;
          if (request_.enough) {
            share = std::max(share, 1.0 * found_ / *request_.enough);
          }
          context_.ReportProgress("transferring",
                                  begin + (end - begin) * share);
          return request_.enough && found_ >= *request_.enough;
        });
    return last;
  }

  const std::optional<Grasp>& FindGrasp(const TransferRecord& record) const {
    return request_.assemble ? record.assembled : record.transferred;
  }

  // Good enough not to look for a better one.
  bool IsSure(const TransferRecord& record) const {
    return FindGrasp(record) &&
           record.robust.gripped >= parameters_.transfer.sure_grip;
  }

  // Of each part those first whose starts promise most, the parts in turn.
  void SortByPromise(std::vector<TransferRecord>& records) const {
    struct Place {
      int turn;
      double promise;
      int index;
    };
    std::vector<Place> order(records.size());
    ParallelFor(static_cast<int>(records.size()), [&](int i) {
      order[i] = {0, CalcPromise(records[i]), i};
    });
    std::stable_sort(
        order.begin(), order.end(),
        [](const Place& a, const Place& b) { return a.promise < b.promise; });
    std::map<int, int> turns;
    for (Place& place : order) place.turn = turns[records[place.index].part]++;
    std::stable_sort(
        order.begin(), order.end(),
        [](const Place& a, const Place& b) { return a.turn < b.turn; });
    std::vector<TransferRecord> sorted;
    for (const Place& place : order) {
      sorted.push_back(std::move(records[place.index]));
    }
    records = std::move(sorted);
  }

  double CalcPromise(const TransferRecord& record) const {
    const PartPair& pair = pairs_[record.part];
    if (!pair.map) return std::numeric_limits<double>::infinity();
    const Grasp& source =
        request_.grasp_spaces[record.part]->grasps[record.source_grasp];
    std::vector<std::optional<Eigen::Vector3d>> targets_N;
    return graspdb::CalcPromise(hand_, MapGrasp(pair, source, targets_N),
                                request_.assemble ? *whole_N_ : *pair.solid_N,
                                parameters_);
  }

  // One source grasp through all stages; touches its own record only.
  // @param is_needed  Says no once others are enough.
  void TransferOne(TransferRecord& record, const Effort& effort,
                   const Wanted& is_needed) const {
    const Wanted wanted = [&] { return is_needed() && !context_.Cancelled(); };
    if (!wanted()) return;
    const uint64_t p = record.part;
    const uint64_t s = record.source_grasp;
    const PartPair& pair = pairs_[p];
    const Grasp& source = request_.grasp_spaces[p]->grasps[s];
    record.example_epsilon = source.quality.epsilon;
    record.example_epsilon_whole = std::max(
        0.0, CloseAndJudge(hand_, source.configuration.X_OH, source.q_pregrasp,
                           *request_.whole_E, parameters_)
                 .grasp.quality.epsilon);
    if (!pair.map) return;

    // Sec. V-A: where its contacts lie on the novel part.
    const TransferTask task = MapGrasp(pair, source, record.targets_N);
    std::vector<Eigen::Vector3d> normals;
    for (const ContactTarget& target : task.targets) {
      normals.push_back(target.nhat_N);
    }
    if (!HasOpposedPair(normals, parameters_.transfer.min_opposed_contacts)) {
      return;
    }
    record.open_close_epsilon_part =
        CalcOpenCloseEpsilon(hand_, task, *pair.solid_N, parameters_);
    if (request_.assemble) {
      record.open_close_epsilon_whole =
          CalcOpenCloseEpsilon(hand_, task, *whole_N_, parameters_);
    }

    // Sec. V-B: a stable grasp of the part …
    const double start = ThreadSeconds();
    // What is to hold in the end is the whole.
    ReplanResult on_part =
        Replan(hand_, task, *pair.solid_N, parameters_,
               DeriveSeed(request_.seed, {kReplan, p, s}),
               {.climb_samples = request_.assemble ? 0 : effort.climb_samples,
                .searches = request_.assemble ? 1 : effort.searches,
                .grip = !request_.assemble,
                .until_sure = effort.until_sure,
                .epsilon_to_beat = record.open_close_epsilon_part,
                .wanted = wanted});
    const double replanned = ThreadSeconds();
    record.transfer_seconds = replanned - start;
    record.transfer = on_part.outcome;
    record.assembly = on_part.outcome;
    if (!on_part.grasp) return;
    record.transferred = Complete(*on_part.grasp, *pair.solid_N);
    record.transferred_clearances =
        surfaces_N_->CalcClearances(hand_, record.transferred->configuration);
    if (!request_.assemble && !KeepsFree(record.transferred_clearances)) {
      record.transfer = TransferOutcome::kNotKeptFree;
      record.assembly = record.transfer;
      record.transferred.reset();
      return;
    }

    // … and Sec. V-C: of the whole object.
    if (request_.assemble) {
      ReplanResult on_whole =
          Assemble(hand_, task, *on_part.grasp, *whole_N_, parameters_,
                   DeriveSeed(request_.seed, {kAssemble, p, s}),
                   {.climb_samples = effort.climb_samples,
                    .searches = effort.searches,
                    .until_sure = effort.until_sure,
                    .epsilon_to_beat = record.open_close_epsilon_whole,
                    .wanted = wanted});
      record.assembly_seconds = ThreadSeconds() - replanned;
      record.assembly = on_whole.outcome;
      if (!on_whole.grasp) return;
      record.assembled_clearances =
          surfaces_N_->CalcClearances(hand_, on_whole.grasp->configuration);
      if (!KeepsFree(record.assembled_clearances)) {
        record.assembly = TransferOutcome::kNotKeptFree;
        return;
      }
      record.assembled = Complete(*on_whole.grasp, *whole_N_);
    }
    if (!is_needed()) return;
    const Grasp& last =
        record.assembled ? *record.assembled : *record.transferred;
    const Solid& solid = record.assembled ? *whole_N_ : *pair.solid_N;
    record.robust = CalcRobustness(hand_, last, solid, parameters_,
                                   DeriveSeed(request_.seed, {kRobust, p, s}));
    record.penetration = CalcPenetration(hand_, last.configuration, solid);
  }

  TransferTask MapGrasp(
      const PartPair& pair, const Grasp& source,
      std::vector<std::optional<Eigen::Vector3d>>& targets_N) const {
    TransferTask task;
    const RigidTransform& X_EH = source.configuration.X_OH;
    task.X_NH.rotation = pair.alignment.X_NE.rotation * X_EH.rotation;
    task.X_NH.translation = pair.alignment * X_EH.translation;
    task.q_pregrasp = source.q_pregrasp;
    task.q = source.configuration.q;
    const auto X_HL = CalcLinkPoses(hand_.model(), task.q);
    for (const Contact& contact : source.contacts) {
      targets_N.push_back(
          pair.map->MapConsistently(contact.p_O, contact.nhat_O));
      if (!targets_N.back()) continue;
      const RigidTransform X_LE = (X_EH * X_HL[contact.link]).Inverse();
      const ClosestPoint on_link =
          *hand_.link(contact.link)->index.FindClosest(X_LE * contact.p_O);
      const ClosestPoint on_N =
          *pair.solid_N->index().FindClosest(*targets_N.back());
      task.targets.push_back({contact.link, on_link.p_M, on_link.pseudonormal,
                              *targets_N.back(), on_N.pseudonormal});
    }
    return task;
  }

  bool KeepsFree(const std::vector<double>& clearances) const {
    return graspdb::KeepsFree(clearances, request_.keep_free,
                              parameters_.transfer.min_clearance);
  }

  // Fills in what is not needed while searching.
  Grasp Complete(Grasp grasp, const Solid& solid) const {
    grasp.quality.hybrid = CalcHybrid(hand_, grasp, solid, parameters_);
    grasp.quality.volume = CalcWrenchVolume(
        CalcContactWrenches(grasp.contacts, solid.mass(), parameters_.contact));
    return grasp;
  }

  const TransferRequest& request_;
  const Parameters& parameters_;
  ExecutionContext& context_;
  const HandShape& hand_;
  std::vector<PartPair> pairs_;
  std::unique_ptr<Solid> whole_N_;
  std::unique_ptr<PartSurfaces> surfaces_N_;  // Of its parts, on the object.
  int found_{0};                              // Sure grasps so far.
  double share_{0.1};  // Of the work, when the next ones are tried.
};

}  // namespace

Result<TransferResult> Transfer(const TransferRequest& request,
                                ExecutionContext& context) {
  GRASPDB_EXPECTS(request.grasp_spaces.size() == request.novel_parts.size());
  return RunWithThreads(request.threads,
                        [&] { return Transferrer(request, context).Run(); });
}

const char* EngineVersion() { return GRASPDB_VERSION; }

}  // namespace graspdb
