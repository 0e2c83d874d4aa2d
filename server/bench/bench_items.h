#pragma once

#include <string>
#include <vector>

#include "engine/base/result.h"
#include "server/bench/paper_bench.h"
#include "server/jobs/service.h"

namespace graspdb {

/** What the rows of one object are made of. */
struct BenchItem {
  std::string group;  ///< "paper", "further", "cloud" or "objects".
  int number{0};      ///< The paper's #1 or #2; 0: none.
  std::string category;
  std::string name;
  ImportOrder mesh;  ///< A cloud's bytes are scanned later, from its mesh.
};

/** Everything that is transferred to, before anything is computed: the novel
 objects of the data folder, two clouds of the first mug, and other people's
 meshes. @retval kNotFound, kInvalidArgument naming the file at fault. */
Result<std::vector<BenchItem>> CollectBenchItems(const PaperBenchOrder& order);

}  // namespace graspdb
