#pragma once

#include <vector>

#include "engine/base/execution_context.h"
#include "engine/base/result.h"
#include "engine/cspace/configuration_space.h"
#include "engine/parameters/learning_parameters.h"

namespace graspdb {

/** One round of active learning, as in Table I and its extensions. */
struct LearningRound {
  int samples{0};  ///< Labels so far.
  int support_vectors{0};
  double balanced_accuracy{0.0};  ///< On held-out uniform samples, 0..1.
  double boundary_accuracy{0.0};  ///< On held-out samples near contact, 0..1.

  bool operator==(const LearningRound&) const = default;
};

/** What active learning leaves behind. */
struct LearnedConfigurationSpace {
  std::vector<LearningRound> rounds;
  /** The collision-free support vectors, those nearest to contact first: the
   particles of the swarm. */
  std::vector<HandPosture> free_support_vectors;
};

/** Approximates the collision-free space by a support vector machine: a uniform
 seed batch, then rounds that label the samples nearest to the decision boundary
 and some at random. Deterministic for a seed on any number of threads.
 @paper{Sec. IV} */
Result<LearnedConfigurationSpace> LearnConfigurationSpace(
    const ConfigurationSpace& space, const ActiveLearningParameters& parameters,
    uint64_t seed, ExecutionContext& context);

}  // namespace graspdb
