#include "engine/cspace/active_learner.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/cspace/svm.h"

namespace graspdb {
namespace {

// What the streams of random numbers are for.
enum Stream : uint64_t { kSeedBatch, kQueries, kTest, kBoundaryTest };

// Held-out boundary samples lie within this change of a contact change.
constexpr double kBoundaryStep = 0.005;               // m
constexpr double kBoundaryTurn = 5.0 * M_PI / 180.0;  // rad

struct Labelled {
  std::vector<HandPosture> postures;
  std::vector<char> collides;  // Not vector<bool>: written by threads.
};

// Draws one posture per index, each from its own stream, and labels them.
Labelled DrawAndLabel(const ConfigurationSpace& space, int count,
                      const std::function<HandPosture(int)>& draw) {
  Labelled result;
  result.postures.resize(count);
  result.collides.resize(count);
  ParallelFor(count, [&](int i) {
    result.postures[i] = draw(i);
    result.collides[i] = space.Collides(result.postures[i]);
  });
  return result;
}

class ActiveLearner {
 public:
  ActiveLearner(const ConfigurationSpace& space,
                const ActiveLearningParameters& parameters, uint64_t seed)
      : space_(space), parameters_(parameters), seed_(seed) {}

  Result<LearnedConfigurationSpace> Run(ExecutionContext& context) {
    LearnedConfigurationSpace result;
    Add(DrawAndLabel(space_, parameters_.seed_samples, [this](int i) {
      Random random(DeriveSeed(seed_, {kSeedBatch, uint64_t(i)}));
      return space_.Sample(random);
    }));
    const Labelled test = DrawTest();
    const Labelled boundary_test = DrawBoundaryTest(test);
    for (int round = 0;; ++round) {
      if (context.Cancelled()) {
        return Error{ErrorCode::kCancelled, "learning was cancelled"};
      }
      // A hand that collides everywhere or nowhere has no boundary to learn.
      const int hits = std::accumulate(samples_.collides.begin(),
                                       samples_.collides.end(), 0);
      if (hits == 0 || hits == static_cast<int>(samples_.collides.size())) {
        return Error{ErrorCode::kUnusableInput,
                     "the hand collides with the part everywhere or nowhere",
                     "check the units of the mesh"};
      }
      const Svm svm = Train();
      result.rounds.push_back({static_cast<int>(samples_.postures.size()),
                               static_cast<int>(svm.support_vectors().size()),
                               CalcBalancedAccuracy(svm, test),
                               CalcBalancedAccuracy(svm, boundary_test)});
      if (round == parameters_.rounds) {
        result.free_support_vectors = ListFreeSupportVectors(svm);
        return result;
      }
      Add(DrawQueries(svm, round));
    }
  }

 private:
  void Add(Labelled batch) {
    std::move(batch.postures.begin(), batch.postures.end(),
              std::back_inserter(samples_.postures));
    samples_.collides.insert(samples_.collides.end(), batch.collides.begin(),
                             batch.collides.end());
  }

  Svm Train() const {
    const int count = static_cast<int>(samples_.postures.size());
    std::vector<bool> labels(samples_.collides.begin(),
                             samples_.collides.end());
    Eigen::MatrixXd features(space_.CalcFeatures(samples_.postures[0]).size(),
                             count);
    for (int i = 0; i < count; ++i) {
      features.col(i) = space_.CalcFeatures(samples_.postures[i]);
    }
    return Svm(features, labels, parameters_.penalty, parameters_.kernel_gamma);
  }

  // Each query is the candidate nearest to the boundary of a small pool of its
  // own; a share is drawn at random instead, to find what the machine missed.
  Labelled DrawQueries(const Svm& svm, int round) const {
    const int explore = static_cast<int>(parameters_.exploration_share *
                                         parameters_.queries_per_round);
    return DrawAndLabel(
        space_, parameters_.queries_per_round,
        [this, &svm, round, explore](int i) {
          Random random(
              DeriveSeed(seed_, {kQueries, uint64_t(round), uint64_t(i)}));
          HandPosture best = space_.Sample(random);
          if (i < explore) return best;
          double best_value =
              std::abs(svm.CalcDecisionValue(space_.CalcFeatures(best)));
          for (int c = 1; c < parameters_.candidates_per_query; ++c) {
            HandPosture candidate = space_.Sample(random);
            const double value =
                std::abs(svm.CalcDecisionValue(space_.CalcFeatures(candidate)));
            if (value < best_value) {
              best_value = value;
              best = std::move(candidate);
            }
          }
          return best;
        });
  }

  Labelled DrawTest() const {
    return DrawAndLabel(space_, parameters_.test_samples, [this](int i) {
      Random random(DeriveSeed(seed_, {kTest, uint64_t(i)}));
      return space_.Sample(random);
    });
  }

  // Samples one small step away from which the label differs.
  Labelled DrawBoundaryTest(const Labelled& test) const {
    Labelled moved = DrawAndLabel(
        space_, static_cast<int>(test.postures.size()), [&](int i) {
          Random random(DeriveSeed(seed_, {kBoundaryTest, uint64_t(i)}));
          return space_.Perturb(test.postures[i], kBoundaryStep, kBoundaryTurn,
                                random);
        });
    Labelled result;
    for (size_t i = 0; i < moved.postures.size(); ++i) {
      if (moved.collides[i] == test.collides[i]) continue;
      result.postures.push_back(moved.postures[i]);
      result.collides.push_back(moved.collides[i]);
      result.postures.push_back(test.postures[i]);
      result.collides.push_back(test.collides[i]);
    }
    return result;
  }

  // The mean of the shares of hits and of misses that are told right.
  double CalcBalancedAccuracy(const Svm& svm, const Labelled& test) const {
    std::vector<char> right(test.postures.size());
    ParallelFor(static_cast<int>(test.postures.size()), [&](int i) {
      const bool says =
          svm.CalcDecisionValue(space_.CalcFeatures(test.postures[i])) > 0.0;
      right[i] = says == static_cast<bool>(test.collides[i]);
    });
    double share = 0.0;
    for (const bool label : {false, true}) {
      int count = 0, correct = 0;
      for (size_t i = 0; i < test.postures.size(); ++i) {
        if (static_cast<bool>(test.collides[i]) != label) continue;
        ++count;
        correct += right[i];
      }
      share += count > 0 ? 0.5 * correct / count : 0.5;
    }
    return share;
  }

  std::vector<HandPosture> ListFreeSupportVectors(const Svm& svm) const {
    std::vector<std::pair<double, int>> order;
    for (const int i : svm.support_vectors()) {
      if (samples_.collides[i]) continue;
      order.emplace_back(
          -svm.CalcDecisionValue(space_.CalcFeatures(samples_.postures[i])), i);
    }
    std::sort(order.begin(), order.end());
    std::vector<HandPosture> result;
    for (const auto& [value, i] : order) {
      result.push_back(samples_.postures[i]);
    }
    return result;
  }

  const ConfigurationSpace& space_;
  const ActiveLearningParameters& parameters_;
  const uint64_t seed_;
  Labelled samples_;
};

}  // namespace

Result<LearnedConfigurationSpace> LearnConfigurationSpace(
    const ConfigurationSpace& space, const ActiveLearningParameters& parameters,
    uint64_t seed, ExecutionContext& context) {
  return ActiveLearner(space, parameters, seed).Run(context);
}

}  // namespace graspdb
