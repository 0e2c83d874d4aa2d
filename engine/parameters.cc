#include "engine/parameters.h"

#include <cmath>
#include <sstream>

namespace graspdb {
namespace {

// Walks all sections and keeps the first violation.
class RangeChecker {
 public:
  template <class Section>
  void operator()(const char* name, const Section& section) {
    const std::string outer = path_;
    path_ += std::string(name) + ".";
    Section::Visit(section, *this);
    path_ = outer;
  }
  template <class T>
  void operator()(const char* name, const T& value, const ParameterInfo& info) {
    const double number = static_cast<double>(value);
    if (violation_.empty() &&
        !(number >= info.minimum && number <= info.maximum)) {
      std::ostringstream text;
      text << path_ << name << " must lie in [" << info.minimum << ", "
           << info.maximum << "] " << info.unit << ", not " << number;
      violation_ = text.str();
      field_ = path_ + name;
    }
  }
  const std::string& violation() const { return violation_; }
  const std::string& field() const { return field_; }

 private:
  std::string path_;
  std::string violation_;
  std::string field_;
};

}  // namespace

Parameters MakeDefaultParameters() { return {}; }

Parameters MakePaperParameters() {
  Parameters p;
  p.segmentation.by_shape_diameter = true;
  p.active_learning.seed_samples = 30000;
  p.active_learning.rounds = 10;
  p.active_learning.queries_per_round = 1000;
  p.swarm.aimed_share = 0.0;
  p.swarm.niches = false;
  p.swarm.hold_on_whole = false;
  p.swarm.min_robustness = 0.0;
  p.swarm.patience = p.swarm.iterations;
  p.mapping.affine = false;
  p.mapping.warp = false;
  p.replan.cycles = 1;
  p.replan.aimed_starts = false;
  p.replan.iterations = 300;
  p.replan.patience = 300;
  p.replan.move_wrist = false;
  return p;
}

Result<void> ValidateParameters(const Parameters& parameters) {
  RangeChecker checker;
  Parameters::Visit(parameters, checker);
  if (checker.violation().empty()) return {};
  return Error{ErrorCode::kInvalidArgument, checker.violation(),
               "GET /v1/parameters lists every range", checker.field()};
}

}  // namespace graspdb
