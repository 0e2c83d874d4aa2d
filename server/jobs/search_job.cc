#include <algorithm>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/geometry/surface_sampling.h"
#include "engine/registration/surface_alignment.h"
#include "server/decode/decode_client.h"
#include "server/jobs/service.h"

namespace graspdb {
namespace {

constexpr int kSamples = 1500;
constexpr uint64_t kSeed = 1;
// So many times as many as are asked for, at least so many, are aligned: those
// whose descriptors are nearest.
constexpr int kCandidatesPerAnswer = 2;
constexpr int kFewestCandidates = 16;

struct Candidate {
  StoredObject object;
  double distance{0.0};
};

}  // namespace

Result<ShapeDescriptor> Service::FindDescriptor(const std::string& id) const {
  if (const auto known = descriptors_.Find(id)) return *known;
  GRASPDB_TRY(meshes, store_->ReadObjectMeshes(id));
  const ShapeDescriptor descriptor =
      CalcShapeDescriptor(SampleSurface(meshes.work, kSamples, kSeed));
  descriptors_.Insert(id, descriptor, sizeof(descriptor));
  return descriptor;
}

Result<std::vector<SimilarObject>> Service::SearchByShape(
    const ImportOrder& order, const ShapeQuery& query,
    ExecutionContext& context) {
  GRASPDB_TRY(checked, CheckImport(order));
  GRASPDB_TRY(decoded, DecodeUpload(checked, context));
  const SurfaceSamples samples_N =
      SampleSurface(decoded.work_O, kSamples, kSeed);
  const ShapeDescriptor descriptor = CalcShapeDescriptor(samples_N);
  std::vector<Candidate> candidates;
  PageRequest page{1000, ""};
  do {
    GRASPDB_TRY(objects,
                store_->ListObjects({query.category, query.role}, page));
    for (StoredObject& object : objects.items) {
      if (context.Cancelled()) {
        return Error{ErrorCode::kCancelled, "The search was cancelled."};
      }
      GRASPDB_TRY(known, FindDescriptor(object.id));
      candidates.push_back(
          {std::move(object), CalcDescriptorDistance(descriptor, known)});
    }
    page.cursor = objects.next_cursor;
  } while (!page.cursor.empty());
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const auto& a, const auto& b) { return a.distance < b.distance; });
  const auto most = static_cast<size_t>(
      std::max(kFewestCandidates, kCandidatesPerAnswer * query.limit));
  if (candidates.size() > most) candidates.resize(most);

  const double half = SegmentationParameters{}.half_similarity;
  std::vector<SurfaceSamples> samples_E;
  for (const Candidate& candidate : candidates) {
    GRASPDB_TRY(meshes, store_->ReadObjectMeshes(candidate.object.id));
    samples_E.push_back(SampleSurface(meshes.work, kSamples, kSeed));
  }
  std::vector<SimilarObject> found(candidates.size());
  RunInArena(options_.threads, [&] {
    ParallelFor(static_cast<int>(candidates.size()), [&](int i) {
      if (context.Cancelled()) return;
      const auto c = static_cast<size_t>(i);
      const SurfaceAlignment alignment =
          AlignSurfaces(samples_E[c], samples_N, AlignmentOptions{});
      found[c] = {std::move(candidates[c].object),
                  CalcSimilarity(alignment, half), alignment.residual,
                  alignment.scale, alignment.X_NE};
    });
  });
  if (context.Cancelled()) {
    return Error{ErrorCode::kCancelled, "The search was cancelled."};
  }
  std::stable_sort(
      found.begin(), found.end(),
      [](const auto& a, const auto& b) { return a.similarity > b.similarity; });
  if (std::ssize(found) > query.limit) {
    found.resize(static_cast<size_t>(query.limit));
  }
  return found;
}

}  // namespace graspdb
