#pragma once

#include <string>

#include "engine/base/execution_context.h"

namespace graspdb {

/** The execution of one piece of a longer work: its progress fills the share
 from `begin` to `end` of the whole's, its stages are told behind `what`, and it
 is cancelled with the whole. */
class SubContext {
 public:
  SubContext(ExecutionContext& whole, const std::string& what, double begin,
             double end)
      : context_(
            [&whole, what, begin, end](const std::string& stage, double share) {
              const bool both = !stage.empty() && !what.empty();
              whole.ReportProgress(what + (both ? ": " : "") + stage,
                                   begin + share * (end - begin));
            }) {
    context_.set_parent(&whole);
  }
  ExecutionContext& context() { return context_; }

 private:
  ExecutionContext context_;
};

}  // namespace graspdb
