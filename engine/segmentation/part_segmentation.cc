#include "engine/segmentation/part_segmentation.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "engine/base/contract.h"
#include "engine/geometry/surface_sampling.h"
#include "engine/registration/surface_alignment.h"
#include "engine/segmentation/face_graph.h"
#include "engine/segmentation/label_transfer.h"
#include "engine/segmentation/shape_diameter.h"

namespace graspdb {
namespace {

// An object that lacks a part is still one of the category from here on.
constexpr double kSimilar = 0.5;

// The example that fits best, laid over the novel object.
struct Match {
  int example{0};
  SurfaceSamples samples_E;
  SurfaceAlignment alignment;
};

// Those that a cloud shows; all when it shows next to nothing.
SurfaceSamples KeepSeen(const SurfaceSamples& samples,
                        const SeenSurface& seen) {
  SurfaceSamples kept;
  for (int i = 0; i < samples.size(); ++i) {
    if (!seen.Shows(samples.points[i])) continue;
    kept.points.push_back(samples.points[i]);
    kept.normals.push_back(samples.normals[i]);
    kept.faces.push_back(samples.faces[i]);
  }
  constexpr int kFewest = 50;
  return kept.size() < kFewest ? samples : kept;
}

std::optional<Match> FindBestExample(const SurfaceSamples& samples_N,
                                     const std::vector<LabelledMesh>& examples,
                                     const SegmentationParameters& parameters,
                                     uint64_t seed, bool partial_N,
                                     const ExecutionContext& context) {
  AlignmentOptions options;
  options.partial_N = partial_N;
  options.normal_weight = parameters.normal_weight;
  options.coarse_samples = parameters.coarse_samples;
  options.refined_starts = parameters.refined_starts;
  std::optional<Match> best;
  for (size_t i = 0; i < examples.size(); ++i) {
    if (context.Cancelled()) return std::nullopt;
    Match match;
    match.example = static_cast<int>(i);
    match.samples_E =
        SampleSurface(examples[i].mesh_O, parameters.samples, seed);
    match.alignment = AlignSurfaces(match.samples_E, samples_N, options);
    if (!best || CalcDissimilarity(match.alignment) <
                     CalcDissimilarity(best->alignment)) {
      best = std::move(match);
    }
  }
  return best;
}

// Each segment gets the label of the least mean cost over its area.
std::vector<int> LabelSegments(const TriangleMesh& mesh,
                               const std::vector<int>& segments,
                               const std::vector<std::vector<double>>& costs) {
  std::map<int, std::vector<double>> totals;
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    auto& total =
        totals.try_emplace(segments[f], costs.size(), 0.0).first->second;
    for (size_t label = 0; label < costs.size(); ++label) {
      total[label] += mesh.area(f) * costs[label][f];
    }
  }
  std::vector<int> labels(segments.size());
  for (size_t f = 0; f < segments.size(); ++f) {
    const auto& total = totals[segments[f]];
    labels[f] = static_cast<int>(std::min_element(total.begin(), total.end()) -
                                 total.begin());
  }
  return labels;
}

// What the topology and area tests compare.
struct PartStatistics {
  std::vector<double> shares;   // Of the object's area, per label.
  std::vector<int> components;  // Connected pieces, per label.
  std::set<std::pair<int, int>> adjacency;
};

PartStatistics CalcStatistics(const TriangleMesh& mesh,
                              const std::vector<int>& face_labels,
                              const std::vector<FaceLink>& links,
                              int num_labels) {
  PartStatistics statistics;
  statistics.shares.assign(num_labels, 0.0);
  statistics.components.assign(num_labels, 0);
  const std::vector<int> components = CalcComponents(face_labels, links);
  int counted = 0;
  for (int f = 0; f < mesh.num_triangles(); ++f) {
    statistics.shares[face_labels[f]] += mesh.area(f) / mesh.total_area();
    if (components[f] == counted) {  // The component's first face.
      ++statistics.components[face_labels[f]];
      ++counted;
    }
  }
  for (const FaceLink& link : links) {
    const int a = face_labels[link.face_a];
    const int b = face_labels[link.face_b];
    if (a != b) statistics.adjacency.insert(std::minmax(a, b));
  }
  return statistics;
}

std::string Format(const char* format, double a, double b) {
  char text[200];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

// Judges the labels; collects a warning for each test that fails.
class Judge {
 public:
  Judge(const PartVocabulary& vocabulary,
        const SegmentationParameters& parameters)
      : vocabulary_(vocabulary), parameters_(parameters) {}

  void CheckResidual(double residual) {
    if (residual <= parameters_.max_residual) return;
    Fail(SegmentationVerdict::kForeign,
         "the shape differs too much from every example of the category" +
             Format(" (residual %.3f, limit %.3f)", residual,
                    parameters_.max_residual));
  }

  // @param similarity  Of the whole: a mug may have lost its handle, a bowl
  //   never had one.
  // @param partial  Areas tell nothing, and a part may be out of sight.
  void CheckShares(const PartStatistics& novel, const PartStatistics& example,
                   double similarity, bool partial) {
    for (size_t label = 0; label < novel.shares.size(); ++label) {
      if (example.shares[label] == 0.0) continue;
      const double ratio = novel.shares[label] / example.shares[label];
      const std::string part = "the " + vocabulary_.labels[label];
      if (ratio == 0.0) {
        Fail(similarity >= kSimilar ? SegmentationVerdict::kUnsure
                                    : SegmentationVerdict::kForeign,
             part + " was not found");
      } else if (!partial && (ratio < parameters_.min_area_ratio ||
                              ratio > parameters_.max_area_ratio)) {
        const bool is_narrow = ratio > 0.5 * parameters_.min_area_ratio &&
                               ratio < 2.0 * parameters_.max_area_ratio;
        Fail(is_narrow ? SegmentationVerdict::kUnsure
                       : SegmentationVerdict::kForeign,
             part + Format(" covers %.0f %% of the area, the example's %.0f %%",
                           100.0 * novel.shares[label],
                           100.0 * example.shares[label]));
      }
    }
  }

  void CheckTopology(const PartStatistics& novel,
                     const PartStatistics& example) {
    for (size_t label = 0; label < novel.components.size(); ++label) {
      if (novel.components[label] == 0 ||
          novel.components[label] == example.components[label]) {
        continue;
      }
      Fail(SegmentationVerdict::kUnsure,
           "the " + vocabulary_.labels[label] +
               Format(" lies in %.0f pieces, the example's in %.0f",
                      novel.components[label], example.components[label]));
    }
    std::set<std::pair<int, int>> expected;
    for (const auto& [a, b] : vocabulary_.adjacency) {
      expected.insert(std::minmax(a, b));
    }
    for (const auto& [a, b] : expected) {
      const bool both_found = novel.shares[a] > 0.0 && novel.shares[b] > 0.0;
      if (!both_found || novel.adjacency.contains({a, b})) continue;
      Fail(SegmentationVerdict::kUnsure, Join(a, b) + " do not touch");
    }
    for (const auto& [a, b] : novel.adjacency) {
      if (expected.contains({a, b})) continue;
      Fail(SegmentationVerdict::kUnsure, Join(a, b) + " touch");
    }
  }

  void CheckConfidence(const std::vector<Part>& parts) {
    for (const Part& part : parts) {
      if (part.confidence >= parameters_.min_confidence) continue;
      Fail(SegmentationVerdict::kUnsure,
           "where the " + vocabulary_.labels[part.label] + " ends is unsure" +
               Format(" (confidence %.2f, limit %.2f)", part.confidence,
                      parameters_.min_confidence));
    }
  }

  SegmentationVerdict verdict() const { return verdict_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  std::string Join(int a, int b) const {
    return "the " + vocabulary_.labels[a] + " and the " + vocabulary_.labels[b];
  }

  void Fail(SegmentationVerdict verdict, std::string warning) {
    verdict_ = std::max(verdict_, verdict);
    warnings_.push_back(std::move(warning));
  }

  const PartVocabulary& vocabulary_;
  const SegmentationParameters& parameters_;
  SegmentationVerdict verdict_{SegmentationVerdict::kMatched};
  std::vector<std::string> warnings_;
};

std::vector<int> PickSampleLabels(const SurfaceSamples& samples,
                                  const std::vector<int>& face_labels) {
  std::vector<int> labels;
  labels.reserve(samples.faces.size());
  for (const int face : samples.faces) labels.push_back(face_labels[face]);
  return labels;
}

}  // namespace

Result<SegmentationResult> SegmentObject(
    const TriangleMesh& mesh_N, const PartVocabulary& vocabulary,
    const std::vector<LabelledMesh>& examples,
    const SegmentationParameters& parameters, uint64_t seed,
    ExecutionContext& context, const SeenSurface* seen_N) {
  const int num_labels = static_cast<int>(vocabulary.labels.size());
  GRASPDB_EXPECTS(!examples.empty() && num_labels > 0);
  SurfaceSamples samples_N = SampleSurface(mesh_N, parameters.samples, seed);
  if (seen_N != nullptr) samples_N = KeepSeen(samples_N, *seen_N);
  const auto match = FindBestExample(samples_N, examples, parameters, seed,
                                     seen_N != nullptr, context);
  if (!match) return Error{ErrorCode::kCancelled, "segmentation was cancelled"};
  const LabelledMesh& example = examples[match->example];

  const double radius = NormalizedSamples(samples_N).radius;
  const std::vector<FaceLink> links = CalcFaceLinks(mesh_N);
  const auto costs =
      CalcLabelCosts(mesh_N, match->samples_E,
                     PickSampleLabels(match->samples_E, example.face_labels),
                     num_labels, match->alignment.map_NE, radius, parameters);

  SegmentationResult result;
  result.face_labels =
      parameters.by_shape_diameter
          ? MergeIslands(mesh_N, links,
                         LabelSegments(mesh_N,
                                       SegmentByShapeDiameter(
                                           mesh_N, links, radius, parameters),
                                       costs),
                         parameters.min_island_share)
          : CutByLabelCosts(mesh_N, links, costs, radius, parameters);
  result.example = match->example;
  result.X_NE = match->alignment.X_NE;
  result.scale = match->alignment.scale;
  result.residual = match->alignment.residual;
  result.similarity =
      CalcSimilarity(match->alignment, parameters.half_similarity);

  const bool partial = seen_N != nullptr;
  Judge judge(vocabulary, parameters);
  judge.CheckResidual(result.residual);
  const PartStatistics novel =
      CalcStatistics(mesh_N, result.face_labels, links, num_labels);
  const PartStatistics known =
      CalcStatistics(example.mesh_O, example.face_labels,
                     CalcFaceLinks(example.mesh_O), num_labels);
  judge.CheckShares(novel, known, partial ? 1.0 : result.similarity, partial);
  judge.CheckTopology(novel, known);

  auto parts = CutIntoParts({mesh_N, result.face_labels}, vocabulary);
  if (parts) {
    result.parts = *std::move(parts);
  } else if (judge.verdict() != SegmentationVerdict::kForeign) {
    return parts.error();
  }
  const std::vector<double> confidence =
      CalcLabelConfidence(mesh_N, result.face_labels, costs);
  for (Part& part : result.parts) part.confidence = confidence[part.label];
  judge.CheckConfidence(result.parts);
  result.verdict = judge.verdict();
  result.warnings = judge.warnings();
  return result;
}

}  // namespace graspdb
