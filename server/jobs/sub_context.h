#pragma once

#include <string>

#include "engine/base/execution_context.h"

namespace graspdb {

/** The execution of one piece of a longer work: its progress fills the share
 from `begin` to `end` of the whole's, its stages are told behind `what`, and it
 hears of the whole's cancellation whenever it reports progress. */
class SubContext {
 public:
  SubContext(ExecutionContext& whole, const std::string& what, double begin,
             double end)
      : context_([this, &whole, what, begin, end](const std::string& stage,
                                                  double share) {
          const bool both = !stage.empty() && !what.empty();
          whole.ReportProgress(what + (both ? ": " : "") + stage,
                               begin + share * (end - begin));
          if (whole.Cancelled()) context_.Cancel();
        }) {
    if (whole.Cancelled()) context_.Cancel();
  }
  ExecutionContext& context() { return context_; }

 private:
  ExecutionContext context_;
};

}  // namespace graspdb
