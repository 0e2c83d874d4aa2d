#include "server/bench/speed/speed_stages.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <span>

#include <fmt/format.h>

#include "engine/base/parallel.h"
#include "engine/base/thread_clock.h"
#include "engine/cspace/configuration_space.h"
#include "engine/geometry/subdivision.h"
#include "engine/geometry/surface_sampling.h"
#include "engine/grasp_engine.h"
#include "engine/planning/grasp_space_search.h"
#include "engine/registration/surface_alignment.h"
#include "engine/registration/surface_warp.h"
#include "engine/segmentation/part_segmentation.h"
#include "engine/transfer/contact_map.h"
#include "server/codec/mesh_writer.h"
#include "server/jobs/segmentation.h"

namespace graspdb {
namespace {

// Beyond what a user may send: a bench makes such meshes itself.
constexpr int64_t kMostTriangles = 4'000'000;

std::span<const uint8_t> AsBytes(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

class StageBench {
 public:
  StageBench(const Service& service, const Decoder& decoder,
             const StageOrder& order, ExecutionContext& context)
      : store_(service.store()),
        service_(service),
        decoder_(decoder),
        order_(order),
        context_(context) {}

  Result<StageReport> Run() {
    for (const TriangleMesh& mesh : order_.meshes) {
      context_.ReportProgress("decode and segment", 0.0);
      GRASPDB_TRY_VOID(MeasureDecoding(mesh));
      GRASPDB_TRY_VOID(MeasureSegmentation(mesh));
    }
    context_.ReportProgress("align and map", 0.4);
    GRASPDB_TRY_VOID(MeasureMapping());
    context_.ReportProgress("transfer", 0.5);
    GRASPDB_TRY_VOID(MeasureTransfer());
    context_.ReportProgress("learn on one thread and on two", 0.7);
    GRASPDB_TRY_VOID(MeasureSearch());
    GRASPDB_TRY_VOID(MeasureLearning());
    GRASPDB_TRY_VOID(DescribeLearning());
    return StageReport{std::move(rows_), std::move(curves_)};
  }

 private:
  void Add(const std::string& name, std::optional<int> triangles, Timing timing,
           std::optional<double> goal = std::nullopt) {
    rows_.push_back({name, triangles, std::move(timing), std::nullopt, goal});
  }

  Result<void> MeasureDecoding(const TriangleMesh& mesh) {
    const std::string text = WriteMesh(mesh, MeshFormat::kObj);
    DecodeRequest request;
    request.format = MeshFormat::kObj;
    Timing read, repair, decimate;
    std::optional<Error> error;
    StopwatchOptions wall = order_.stopwatch;
    wall.wall = true;
    const Timing whole = TimeCalls(
        [&] {
          const auto decoded = decoder_.Decode(AsBytes(text), request);
          if (!decoded) {
            error = decoded.error();
            return 0;
          }
          read.samples.push_back(decoded->seconds.read);
          repair.samples.push_back(decoded->seconds.repair);
          decimate.samples.push_back(decoded->seconds.decimate);
          return decoded->mesh_O.num_triangles();
        },
        wall);
    if (error) return *error;
    const int triangles = mesh.num_triangles();
    Add("decode, in a sandboxed process", triangles, whole);
    Add("decode: what the process and its sandbox cost", triangles,
        MakeTiming(CalcMedian(whole) - CalcMedian(read) - CalcMedian(repair) -
                   CalcMedian(decimate)),
        triangles <= 7000 ? 0.010 : 0.025);
    Add("decode: read", triangles, read);
    Add("decode: repair", triangles, repair);
    Add("decode: decimate", triangles, decimate);
    return {};
  }

  // Of the mesh that is searched on, as an import does it.
  Result<void> MeasureSegmentation(const TriangleMesh& mesh) {
    GRASPDB_TRY(category, store_.FindCategory(order_.category));
    DecodeRequest request;
    request.format = MeshFormat::kObj;
    GRASPDB_TRY(
        decoded,
        decoder_.Decode(AsBytes(WriteMesh(mesh, MeshFormat::kObj)), request));
    ObjectMeshes meshes;
    meshes.canonical = decoded.mesh_O;
    meshes.work = decoded.work_O;
    std::optional<Error> error;
    const Timing timing = TimeCalls(
        [&] {
          const auto segmented =
              SegmentByExamples(store_, category, category.segmentation, meshes,
                                "", order_.seed, context_);
          if (!segmented) error = segmented.error();
          return segmented ? segmented->parts.size() : 0;
        },
        WallClock());
    if (error) return *error;
    const int triangles = mesh.num_triangles();
    Add("segment", triangles, timing, triangles <= 7000 ? 0.15 : 0.6);
    return {};
  }

  StopwatchOptions WallClock() const {
    StopwatchOptions options = order_.stopwatch;
    options.wall = true;
    return options;
  }

  // The first example and what was learned of it, and the first mesh segmented.
  struct Pair {
    LabelledMesh example;
    std::vector<Part> example_parts;
    LabelledMesh novel;
    SegmentationResult segmented;
    std::vector<std::shared_ptr<const GraspSpace>> spaces;  // By label.
  };

  Result<Pair> MakePair() const {
    Pair pair;
    GRASPDB_TRY(category, store_.FindCategory(order_.category));
    GRASPDB_TRY(examples, LoadExamples(store_, order_.category, ""));
    pair.example = examples.meshes.front();
    GRASPDB_TRY(stored, store_.ListParts(examples.ids.front()));
    GRASPDB_TRY(parts, store_.ReadSolids(stored));
    pair.example_parts = std::move(parts);
    pair.novel.mesh_O = order_.meshes.front();
    GRASPDB_TRY(segmented,
                SegmentObject(pair.novel.mesh_O, MakeVocabulary(category),
                              {pair.example}, category.segmentation,
                              order_.seed, context_));
    pair.novel.face_labels = segmented.face_labels;
    pair.segmented = std::move(segmented);
    pair.spaces.resize(category.parts.size());
    GRASPDB_TRY(spaces,
                store_.ListGraspSpaces(
                    {order_.category, "", kDefaultHand, examples.ids.front()},
                    {1000, ""}));
    for (const StoredGraspSpace& record : spaces.items) {
      for (size_t label = 0; label < category.parts.size(); ++label) {
        if (category.parts[label].label != record.part_label) continue;
        GRASPDB_TRY(space, store_.ReadGraspSpace(record.id));
        pair.spaces[label] =
            std::make_shared<const GraspSpace>(std::move(space));
      }
    }
    return pair;
  }

  Result<void> MeasureMapping() {
    GRASPDB_TRY(pair, MakePair());
    const MappingParameters mapping;
    const Part& part_N = pair.segmented.parts.front();
    const auto at = std::find_if(
        pair.example_parts.begin(), pair.example_parts.end(),
        [&](const Part& part) { return part.label == part_N.label; });
    if (at == pair.example_parts.end()) {
      return Error{ErrorCode::kInternal, "The example lacks a part."};
    }
    const auto sample = [&](const Part& part) {
      return SamplePoissonDisk(part.solid_O, mapping.samples, order_.seed,
                               part.num_surface_faces);
    };
    const SurfaceSamples samples_E = sample(*at);
    const SurfaceSamples samples_N = sample(part_N);
    Add("samples of a part", std::nullopt,
        TimeCalls([&] { return sample(part_N).size(); }, order_.stopwatch));
    SurfaceAlignment start;
    start.X_NE = pair.segmented.X_NE;
    start.scale = pair.segmented.scale;
    AlignmentOptions options;
    options.normal_weight = mapping.normal_weight;
    Add("align a part", std::nullopt,
        TimeCalls(
            [&] {
              return RefineAlignment(samples_E, samples_N, start, options)
                  .residual;
            },
            order_.stopwatch));
    const SurfaceIndex index_E(at->solid_O);
    const SurfaceIndex index_N(part_N.solid_O);
    const AffineMap map_NE =
        RefineAlignment(samples_E, samples_N, start, options).map_NE;
    Add("contact map of a part", std::nullopt,
        TimeCalls(
            [&] {
              return ContactMap(samples_E, samples_N,
                                WarpSamples(MapSamples(samples_E, map_NE),
                                            samples_N, mapping),
                                index_E, index_N, mapping)
                  .CalcMappedShare();
            },
            order_.stopwatch));
    return {};
  }

  Result<void> MeasureTransfer() {
    GRASPDB_TRY(pair, MakePair());
    TransferRequest request;
    GRASPDB_TRY(hand, service_.FindHandShape(kDefaultHand));
    request.hand = hand;
    request.whole_E = std::make_shared<const Solid>(pair.example.mesh_O);
    request.novel = pair.novel;
    request.example_parts = pair.example_parts;
    request.novel_parts = pair.segmented.parts;
    request.X_NE = pair.segmented.X_NE;
    request.scale = pair.segmented.scale;
    for (const Part& part : request.novel_parts) {
      request.grasp_spaces.push_back(
          pair.spaces[static_cast<size_t>(part.label)]);
    }
    request.sources_per_part = order_.sources;
    request.seed = order_.seed;
    GRASPDB_TRY(
        result,
        OnOneThreadAndTwo(
            fmt::format("transfer of {} sources a part", order_.sources),
            [&](int threads) {
              request.threads = threads;
              return Transfer(request, context_);
            },
            [](const TransferResult& a, const TransferResult& b) {
              return std::equal(a.records.begin(), a.records.end(),
                                b.records.begin(), b.records.end(),
                                [](const auto& x, const auto& y) {
                                  return x.assembled == y.assembled;
                                });
            }));
    Timing replan, assemble, both;
    for (const TransferRecord& record : result.records) {
      if (record.transfer_seconds == 0.0) continue;
      replan.samples.push_back(record.transfer_seconds);
      assemble.samples.push_back(record.assembly_seconds);
      both.samples.push_back(record.transfer_seconds + record.assembly_seconds);
    }
    Add("replan a grasp on its part", std::nullopt, replan);
    Add("assemble a grasp", std::nullopt, assemble);
    Add("one grasp, both stages", std::nullopt, both, 0.025);
    return {};
  }

  // What a distinct stable grasp of a part costs one thread that searches from
  // scratch, as planners count: particles are aimed at the surface or start
  // near what was found, and neither the whole object, motors, disturbed copies
  // nor the order in which fingers arrive have a say.
  Result<void> MeasureSearch() {
    GRASPDB_TRY(examples, LoadExamples(store_, order_.category, ""));
    GRASPDB_TRY(stored, store_.ListParts(examples.ids.front()));
    GRASPDB_TRY(parts, store_.ReadSolids(stored));
    GRASPDB_TRY(hand, service_.FindHandShape(kDefaultHand));
    const Solid part(parts.front().solid_O, parts.front().num_surface_faces);
    const ConfigurationSpace space(*hand, part);
    Parameters parameters;
    parameters.swarm.aimed_share = 1.0;
    parameters.swarm.near_share = 0.9;
    parameters.swarm.min_grip = 0.0;
    parameters.swarm.grip_weight = 0.0;
    parameters.pregrasp.timed = false;
    parameters.swarm.target_grasps = 100'000;
    parameters.swarm.iterations = 1'000'000;
    ExecutionContext timed;
    timed.set_parent(&context_);
    timed.set_deadline(ExecutionContext::Clock::now() +
                       std::chrono::seconds(order_.search_seconds));
    GraspSearchResult found;
    double seconds = 0.0;
    RunInArena(1, [&] {
      const double start = ThreadSeconds();
      found = SearchGraspSpace(*hand, part, nullptr, space, {}, parameters,
                               order_.seed, timed);
      seconds = ThreadSeconds() - start;
    });
    if (found.grasps.empty()) {
      return Error{ErrorCode::kInternal, "The search found no grasp."};
    }
    Add("a distinct stable grasp from scratch", std::nullopt,
        MakeTiming(seconds / static_cast<double>(found.grasps.size())),
        1.0 / 2400.0);
    return {};
  }

  // The first example's first part, once more.
  Result<void> MeasureLearning() {
    GRASPDB_TRY(examples, LoadExamples(store_, order_.category, ""));
    GRASPDB_TRY(stored, store_.ListParts(examples.ids.front()));
    GRASPDB_TRY(parts, store_.ReadSolids(stored));
    LearnRequest request;
    GRASPDB_TRY(hand, service_.FindHandShape(kDefaultHand));
    request.hand = hand;
    request.part_E = parts.front();
    request.whole_E = examples.meshes.front();
    request.parameters.swarm.target_grasps = order_.grasps;
    request.seed = order_.seed;
    const auto learned = OnOneThreadAndTwo(
        fmt::format("learn {} grasps of a part", order_.grasps),
        [&](int threads) {
          request.threads = threads;
          return Learn(request, context_);
        },
        [](const GraspSpace& a, const GraspSpace& b) {
          return a.grasps == b.grasps;
        });
    return learned ? Result<void>() : Result<void>(learned.error());
  }

  // Times work(threads). @returns what it made on one thread.
  template <class Work, class Equal>
  auto OnOneThreadAndTwo(const std::string& name, const Work& work,
                         const Equal& equal) -> decltype(work(1)) {
    GrowthCurve curve{name, "threads", "s", {}, {}};
    const auto time = [&](int threads) {
      const double begin = Now();
      auto result = work(threads);
      curve.x.push_back(threads);
      curve.y.push_back(Now() - begin);
      return result;
    };
    auto one = time(1);
    if (!one) return one;
    const auto two = time(2);
    if (!two) return two.error();
    if (!equal(*one, *two)) {
      return Error{ErrorCode::kInternal,
                   name + ": two threads find other grasps than one."};
    }
    curves_.push_back(std::move(curve));
    return one;
  }

  // As the database tells of it.
  Result<void> DescribeLearning() {
    GRASPDB_TRY(spaces,
                store_.ListGraspSpaces({order_.category, "", kDefaultHand, ""},
                                       {1000, ""}));
    for (const StoredGraspSpace& space : spaces.items) {
      const std::string what = "learn " + space.part_label;
      Add(what, std::nullopt, MakeTiming(space.seconds), 10.0);
      Add(what + ": labels and classifier", std::nullopt,
          MakeTiming(space.configuration_space_seconds));
      Add(what + ": swarm", std::nullopt,
          MakeTiming(space.seconds - space.configuration_space_seconds));
    }
    return {};
  }

  const Store& store_;
  const Service& service_;
  const Decoder& decoder_;
  const StageOrder& order_;
  ExecutionContext& context_;
  std::vector<SpeedRow> rows_;
  std::vector<GrowthCurve> curves_;
};

}  // namespace

Result<StageReport> MeasureStages(const Service& service,
                                  const Decoder& decoder,
                                  const StageOrder& order,
                                  ExecutionContext& context) {
  return StageBench(service, decoder, order, context).Run();
}

Result<TriangleMesh> ResampleMesh(const Decoder& decoder,
                                  const TriangleMesh& mesh, int triangles) {
  TriangleMesh finer = mesh;
  while (finer.num_triangles() < triangles) finer = Subdivide(finer);
  DecodeRequest request;
  request.format = MeshFormat::kPly;
  request.limits.max_triangles = kMostTriangles;
  request.work_triangles = triangles;
  GRASPDB_TRY(
      decoded,
      decoder.Decode(AsBytes(WriteMesh(finer, MeshFormat::kPly)), request));
  return std::move(decoded.work_O);
}

}  // namespace graspdb
