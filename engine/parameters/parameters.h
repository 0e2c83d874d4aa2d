#pragma once

#include <string>

#include "engine/base/result.h"
#include "engine/parameters/grasp_parameters.h"
#include "engine/parameters/learning_parameters.h"
#include "engine/parameters/transfer_parameters.h"

namespace graspdb {

/** Every tunable of the engine. */
struct Parameters {
  SegmentationParameters segmentation;
  ContactParameters contact;
  HybridParameters hybrid;
  MotorParameters motors;
  GripParameters grip;
  HoldParameters hold;
  ActiveLearningParameters active_learning;
  SwarmParameters swarm;
  DistinctParameters distinct;
  PregraspParameters pregrasp;
  MappingParameters mapping;
  ReplanParameters replan;
  TransferLimits transfer;

  template <class Self, class F>
  static void Visit(Self& self, F&& f) {
    f("segmentation", self.segmentation);
    f("contact", self.contact);
    f("hybrid", self.hybrid);
    f("motors", self.motors);
    f("grip", self.grip);
    f("hold", self.hold);
    f("active_learning", self.active_learning);
    f("swarm", self.swarm);
    f("distinct", self.distinct);
    f("pregrasp", self.pregrasp);
    f("mapping", self.mapping);
    f("replan", self.replan);
    f("transfer", self.transfer);
  }
  bool operator==(const Parameters&) const = default;
};

/** The best we know. */
Parameters MakeDefaultParameters();

/** The method as printed, typographical errors mended: shape-diameter
 segmentation, 40,000 labels, rigid alignment, joints only in replanning. */
Parameters MakePaperParameters();

/** What learning depends on, all else at its default: two sets that differ
 elsewhere lead to the same grasp space. */
Parameters SelectForLearning(const Parameters& parameters);

/** Calls visit(path, value, info) for every field, path being "swarm.radius".
 */
template <class Visit>
void VisitFields(const Parameters& parameters, const Visit& visit) {
  Parameters::Visit(parameters, [&](const char* name, const auto& section) {
    section.Visit(section, [&](const char* field, const auto& value,
                               const ParameterInfo& info) {
      visit(std::string(name) + "." + field, value, info);
    });
  });
}

/** Every field within its range.
 @retval kInvalidArgument naming the first field that is not. */
Result<void> ValidateParameters(const Parameters& parameters);

}  // namespace graspdb
